//! Values of a scene that may be written in several ways.

use std::{
    borrow::Cow,
    ops::{Deref, Range},
};

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, de::Error};
use toml::{Spanned, Value};

/// A value at its place in the text.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct At<T> {
    value: T,
    place: Range<usize>,
}

impl<T> At<T> {
    /// A value at a place, in bytes of the text.
    pub fn new(place: Range<usize>, value: T) -> Self {
        Self { value, place }
    }

    /// The place.
    pub fn span(&self) -> Range<usize> {
        self.place.clone()
    }
}

impl<T> Deref for At<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for At<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let spanned = Spanned::<T>::deserialize(deserializer)?;
        Ok(Self { place: spanned.span(), value: spanned.into_inner() })
    }
}

impl<T: JsonSchema> JsonSchema for At<T> {
    fn inline_schema() -> bool {
        T::inline_schema()
    }
    fn schema_name() -> Cow<'static, str> {
        T::schema_name()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        T::json_schema(generator)
    }
}

/// A formula: a string, or a number.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Text(#[serde(deserialize_with = "text")] pub String);

/// A whole number of at least 1. 1e6 is one, too.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct Count(#[serde(deserialize_with = "whole")] pub u64);

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

fn text<'de, D: Deserializer<'de>>(deserializer: D) -> Result<String, D::Error> {
    let text = Text::try_from(Value::deserialize(deserializer)?);
    text.map(|Text(text)| text).map_err(D::Error::custom)
}

fn whole<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u64, D::Error> {
    let text = match Value::deserialize(deserializer)? {
        Value::Integer(number) => number.to_string(),
        Value::Float(number) => number.to_string(),
        other => other.type_str().into(),
    };
    count(&text).map_err(D::Error::custom)
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
