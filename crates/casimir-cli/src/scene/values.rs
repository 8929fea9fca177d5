//! Values of a scene that may be written in several ways.

use std::{borrow::Cow, fmt};

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{
    Deserialize, Deserializer,
    de::{Error, SeqAccess, Visitor},
};

/// A formula: a string, or a number.
#[derive(Clone, Debug, PartialEq)]
pub struct Text(pub String);

/// A whole number of at least 1. 1e6 is one, too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Count(pub u64);

/// A parameter: a number, a formula without names, or a list of them.
#[derive(Clone, Debug, PartialEq)]
pub enum Parameter {
    /// A number or a formula.
    One(Text),
    /// A list.
    Many(Vec<Text>),
    /// `true` or `false`.
    Switch(bool),
}

fn finite<E: Error>(value: f64) -> Result<Text, E> {
    match value.is_finite() {
        true => Ok(Text(format!("{value:?}"))),
        false => Err(E::custom(format_args!("a number must be finite, got {value}"))),
    }
}

struct TextVisitor;

impl Visitor<'_> for TextVisitor {
    type Value = Text;
    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number or a formula in quotes, such as \"y1^2/2\"")
    }
    fn visit_str<E: Error>(self, text: &str) -> Result<Text, E> {
        Ok(Text(text.to_owned()))
    }
    fn visit_i64<E: Error>(self, number: i64) -> Result<Text, E> {
        Ok(Text(number.to_string()))
    }
    fn visit_f64<E: Error>(self, number: f64) -> Result<Text, E> {
        finite(number)
    }
}

impl<'de> Deserialize<'de> for Text {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(TextVisitor)
    }
}

struct CountVisitor;

impl Visitor<'_> for CountVisitor {
    type Value = Count;
    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a whole number of at least 1, such as 1000 or 1e6")
    }
    fn visit_i64<E: Error>(self, number: i64) -> Result<Count, E> {
        match u64::try_from(number) {
            Ok(number) if number > 0 => Ok(Count(number)),
            _ => Err(E::invalid_value(serde::de::Unexpected::Signed(number), &self)),
        }
    }
    fn visit_f64<E: Error>(self, number: f64) -> Result<Count, E> {
        // Beyond 2⁵³ a number is not exact.
        match number.fract() == 0.0 && (1.0..=9e15).contains(&number) {
            true => Ok(Count(number as u64)),
            false => Err(E::invalid_value(serde::de::Unexpected::Float(number), &self)),
        }
    }
}

impl<'de> Deserialize<'de> for Count {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(CountVisitor)
    }
}

struct ParameterVisitor;

impl<'de> Visitor<'de> for ParameterVisitor {
    type Value = Parameter;
    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, such as 0.5 or \"pi/4\", or a list of numbers")
    }
    fn visit_bool<E: Error>(self, switch: bool) -> Result<Parameter, E> {
        Ok(Parameter::Switch(switch))
    }
    fn visit_str<E: Error>(self, text: &str) -> Result<Parameter, E> {
        TextVisitor.visit_str(text).map(Parameter::One)
    }
    fn visit_i64<E: Error>(self, number: i64) -> Result<Parameter, E> {
        TextVisitor.visit_i64(number).map(Parameter::One)
    }
    fn visit_f64<E: Error>(self, number: f64) -> Result<Parameter, E> {
        finite(number).map(Parameter::One)
    }
    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Parameter, A::Error> {
        let mut many = Vec::new();
        while let Some(text) = list.next_element()? {
            many.push(text);
        }
        Ok(Parameter::Many(many))
    }
}

impl<'de> Deserialize<'de> for Parameter {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ParameterVisitor)
    }
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
