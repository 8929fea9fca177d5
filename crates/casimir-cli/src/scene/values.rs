//! Values of a scene that may be written in several ways.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use toml::Value;

/// A formula: a string, or a number.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(try_from = "Value")]
pub struct Text(pub String);

/// A whole number of at least 1. 1e6 is one, too.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "Value")]
pub struct Count(pub u64);

/// A parameter: a number, a formula without names, or a list of them.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(try_from = "Value")]
pub enum Parameter {
    /// A number or a formula.
    One(Text),
    /// A list.
    Many(Vec<Text>),
    /// `true` or `false`.
    Switch(bool),
}

impl TryFrom<Value> for Text {
    type Error = String;

    fn try_from(value: Value) -> Result<Self, String> {
        match value {
            Value::String(text) => Ok(Self(text)),
            Value::Integer(number) => Ok(Self(number.to_string())),
            Value::Float(number) if number.is_finite() => Ok(Self(format!("{number:?}"))),
            Value::Float(number) => Err(format!("a number must be finite, got {number}")),
            other => Err(format!(
                "got a value of type {}, expected a number or a formula in quotes, such as \
                 \"y1^2/2\"",
                other.type_str()
            )),
        }
    }
}

impl TryFrom<Value> for Count {
    type Error = String;

    fn try_from(value: Value) -> Result<Self, String> {
        let text = match value {
            Value::Integer(number) => number.to_string(),
            Value::Float(number) => number.to_string(),
            other => other.type_str().into(),
        };
        count(&text).map(Self)
    }
}

impl TryFrom<Value> for Parameter {
    type Error = String;

    fn try_from(value: Value) -> Result<Self, String> {
        match value {
            Value::Boolean(switch) => Ok(Self::Switch(switch)),
            Value::Array(list) => {
                list.into_iter().map(Text::try_from).collect::<Result<_, _>>().map(Self::Many)
            }
            one => Text::try_from(one).map(Self::One),
        }
    }
}

/// A whole number of at least 1 from its text.
pub fn count(text: &str) -> Result<u64, String> {
    let float = || {
        // Beyond 2⁵³ a number is not exact.
        let whole = |number: &f64| number.fract() == 0.0 && *number <= 9e15;
        text.parse().ok().filter(whole).map(|number| number as u64)
    };
    let number = text.parse().ok().or_else(float).filter(|&number| number > 0);
    number
        .ok_or_else(|| format!("`{text}` is not a whole number of at least 1, such as 1000 or 1e6"))
}

macro_rules! schema {
    ($type:ty, $name:literal, $($schema:tt)+) => {
        impl JsonSchema for $type {
            fn schema_name() -> Cow<'static, str> {
                $name.into()
            }
            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!($($schema)+)
            }
        }
    };
}

schema!(Text, "Formula", { "type": ["string", "number"] });
schema!(Count, "Count", { "type": "number", "minimum": 1, "multipleOf": 1 });
schema!(Parameter, "Parameter", {
    "type": ["string", "number", "boolean", "array"],
    "items": { "type": ["string", "number"] }
});
