//! Values of a scene that may be written in several ways.

use std::{
    borrow::Cow,
    fmt::{self, Display, Formatter},
    marker::PhantomData,
    ops::{Deref, Range},
    str::FromStr,
};

use indexmap::IndexMap;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{
    Deserialize, Deserializer, Serialize,
    de::{
        Error, MapAccess, SeqAccess, Visitor,
        value::{MapAccessDeserializer, SeqAccessDeserializer},
    },
};
use toml::{Spanned, Value};

/// A value at its place in the text.
#[derive(Clone, PartialEq, Eq, Hash, JsonSchema)]
#[schemars(transparent)]
pub struct At<T> {
    value: T,
    #[schemars(skip)]
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

/// The place of an optional value.
pub fn place<T>(of: &Option<At<T>>) -> Option<Range<usize>> {
    of.as_ref().map(At::span)
}

impl<T> From<&At<T>> for Option<Range<usize>> {
    fn from(at: &At<T>) -> Self {
        Some(at.span())
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

/// A formula: a string, or a number.
#[derive(Clone)]
pub struct Text(pub String);

impl From<String> for Text {
    fn from(text: String) -> Self {
        Self(text)
    }
}

/// A whole number of at least 1. 1e6 is one, too.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Count(pub u64);

impl FromStr for Count {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        count(text).map(Self)
    }
}

impl Display for Count {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        if self.0 < 1_000_000 { self.0.fmt(f) } else { fmt::LowerExp::fmt(&self.0, f) }
    }
}

/// A whole number of 64 bits; one that TOML has no number for stands in quotes.
#[derive(Clone, Copy)]
pub struct Seed(pub u64);

/// A parameter: a number, a formula without names, or a list of them.
#[derive(Clone)]
pub enum Parameter {
    /// A number or a formula.
    One(Text),
    /// A list.
    Many(Vec<Text>),
    /// `true` or `false`.
    Switch(bool),
}

/// A list, or a text that stands for one.
#[derive(Clone, JsonSchema)]
#[schemars(untagged)]
pub enum Listed<T> {
    /// The list.
    List(Vec<T>),
    /// The text.
    Text(String),
}

/// A name.
pub type Name = At<String>;

/// The names without their places.
pub fn strings(names: &[Name]) -> Vec<String> {
    names.iter().map(|name| name.to_string()).collect()
}

/// Values by name.
pub type Named<T> = IndexMap<Name, At<T>>;

/// A list at its place, of values at theirs.
pub type List<T> = At<Vec<At<T>>>;

/// A row of a matrix, or another list of formulas.
pub type Formulas = List<Text>;

/// The texts of formulas.
pub fn words(formulas: &Formulas) -> Vec<String> {
    formulas.iter().map(|text| text.0.clone()).collect()
}

/// The matrix B: all rows or the entries above the diagonal; or blocks such as
/// `"spins(s1, s2) + canonical(q, p)"`.
pub type Structure = Listed<Formulas>;

/// The initial value: a number or a formula for each component, or a file of states.
pub type Start = Listed<At<Text>>;

/// A table, or a list of tables.
#[derive(Clone, JsonSchema)]
#[schemars(untagged)]
pub enum Few<T> {
    /// One table.
    One(T),
    /// Any number of tables.
    Many(Vec<T>),
}

impl<T> Default for Few<T> {
    fn default() -> Self {
        Self::Many(Vec::new())
    }
}

impl<T> Deref for Few<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        match self {
            Self::One(one) => std::slice::from_ref(one),
            Self::Many(many) => many,
        }
    }
}

/// Reads a list, whose items keep their places, or what stands for one.
macro_rules! one_or_list {
    ($type:ident, $visitor:ident, $expected:literal, $list:expr, $($visit_one:tt)+) => {
        impl<'de, T: Deserialize<'de>> Deserialize<'de> for $type<T> {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserializer.deserialize_any($visitor(PhantomData))
            }
        }

        struct $visitor<T>(PhantomData<T>);

        impl<'de, T: Deserialize<'de>> Visitor<'de> for $visitor<T> {
            type Value = $type<T>;

            fn expecting(&self, f: &mut Formatter<'_>) -> fmt::Result {
                f.write_str($expected)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Self::Value, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(seq)).map($list)
            }

            $($visit_one)+
        }
    };
}

one_or_list! { Listed, OfListed, "a list, or a text", Listed::List,
    fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
        Ok(Listed::Text(text.to_owned()))
    }
}

one_or_list! { Few, OfFew, "a table, or a list of tables", Few::Many,
    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        T::deserialize(MapAccessDeserializer::new(map)).map(Few::One)
    }
}

/// Reads a list, or its only item.
pub(crate) fn list<'de, D, T>(deserializer: D) -> Result<List<T>, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de> + From<String>,
{
    let At { value, place } = At::<Listed<At<T>>>::deserialize(deserializer)?;
    let items = match value {
        Listed::List(items) => items,
        Listed::Text(text) => vec![At::new(place.clone(), text.into())],
    };
    Ok(At { value: items, place })
}

/// [`list`] of a key that may be left out.
pub(crate) fn some_list<'de, D, T>(deserializer: D) -> Result<Option<List<T>>, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de> + From<String>,
{
    list(deserializer).map(Some)
}

/// The items of a [`list`].
pub(crate) fn items<'de, D, T>(deserializer: D) -> Result<Vec<At<T>>, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de> + From<String>,
{
    list(deserializer).map(|at| at.value)
}

/// An event: the condition when it happens, or a table of it.
#[derive(Clone)]
pub struct Event(pub EventTable);

/// The keys of an event.
#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EventTable {
    /// The condition.
    pub when: Text,
    /// Whether the path stays where it is from then on.
    #[serde(default)]
    pub stop: bool,
}

/// The values of a parameter that is varied: a list, or `"from:to:number"`.
#[derive(Clone)]
pub struct Values(pub Vec<String>);

impl Values {
    /// Reads `0.1,0.2,1/3`, or `from:to:number`.
    pub fn new(text: &str) -> Result<Self, String> {
        let ends: Vec<&str> = text.split(':').map(str::trim).collect();
        match ends[..] {
            [range] if range.contains("..") => {
                let range = range.replace("..", ":");
                Err(format!("{text} is no number: a range is {range}:N, where N values are taken"))
            }
            [_] => Ok(Self(text.split(',').map(|value| value.trim().into()).collect())),
            [from, to, number] => {
                let number_of = |end: &str| match end.parse() {
                    Ok(number) if f64::is_finite(number) => Ok(number),
                    _ => Err(format!("`{end}` in {text} is not a number")),
                };
                let (from, to, number) = (number_of(from)?, number_of(to)?, count(number)?);
                let last = (number - 1).max(1) as f64;
                // Ten digits, so that no value ends with rounding errors.
                let value = |k: u64| {
                    let text = format!("{:.9e}", from + (to - from) * k as f64 / last);
                    text.parse().map_or(text, |x: f64| format!("{x:?}"))
                };
                Ok(Self((0..number.min(MAX_VALUES + 1)).map(value).collect()))
            }
            _ => Err(format!("{text} is neither values such as 0.1,0.2 nor from:to:number")),
        }
    }
}

/// Largest number of combinations: more take more files and pages than anybody reads.
pub const MAX_VALUES: u64 = 10_000;

/// A number as it is written, or what stands in its place.
pub fn number(value: &Value) -> String {
    match value {
        Value::Integer(number) => number.to_string(),
        Value::Float(number) => number.to_string(),
        other => other.type_str().into(),
    }
}

/// A whole number of at least 1 from its text.
pub fn count(text: &str) -> Result<u64, String> {
    // Beyond 2⁵³ a number is not exact.
    let whole = |number: &f64| number.fract() == 0.0 && *number <= 9e15;
    let float = || text.parse().ok().filter(whole).map(|number| number as u64);
    let number = text.parse().ok().or_else(float).filter(|&number| number > 0);
    number
        .ok_or_else(|| format!("`{text}` is not a whole number of at least 1, such as 1000 or 1e6"))
}

/// A formula from a string or a number.
fn text(value: Value) -> Result<Text, String> {
    match value {
        Value::String(text) => Ok(Text(text)),
        Value::Integer(number) => Ok(Text(number.to_string())),
        Value::Float(number) if number.is_finite() => Ok(Text(format!("{number:?}"))),
        Value::Float(number) => Err(format!("a number must be finite, got {number}")),
        other => {
            let got = other.type_str();
            Err(format!("got {got}, expected a number or a formula in quotes: \"y1^2/2\""))
        }
    }
}

fn texts(list: Vec<Value>) -> Result<Vec<Text>, String> {
    list.into_iter().map(text).collect()
}

/// A seed as it is written.
pub fn seed(text: &str) -> Result<u64, String> {
    let wrong = || format!("`{text}` is not a seed: a whole number from 0 to {}", u64::MAX);
    text.parse().map_err(|_| wrong())
}

/// Types with their names and schemas, and how a value is read.
macro_rules! written {
    ($($type:ident, $name:literal, $schema:tt, $read:expr;)+) => {$(
        impl JsonSchema for $type {
            fn schema_name() -> Cow<'static, str> {
                $name.into()
            }
            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!($schema)
            }
        }
        impl<'de> Deserialize<'de> for $type {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let read: fn(Value) -> Result<Self, String> = $read;
                read(Value::deserialize(deserializer)?).map_err(Error::custom)
            }
        }
    )+};
}

written! {
    Text, "Formula", { "type": ["string", "number"] }, text;
    Count, "Count", { "type": "number", "minimum": 1, "multipleOf": 1 },
        |value| count(&number(&value)).map(Self);
    Seed, "Seed", { "type": ["integer", "string"], "minimum": 0 }, |value| {
        seed(&value.as_str().map_or_else(|| number(&value), str::to_owned)).map(Self)
    };
    Parameter, "Parameter", {
        "type": ["string", "number", "boolean", "array"],
        "items": { "type": ["string", "number"] }
    }, |value| match value {
        Value::Boolean(switch) => Ok(Self::Switch(switch)),
        Value::Array(list) => texts(list).map(Self::Many),
        one => text(one).map(Self::One),
    };
    Values, "Values", {
        "type": ["array", "string", "number"],
        "items": { "type": ["string", "number"] }
    }, |value| match value {
        Value::String(text) => Self::new(&text),
        Value::Array(list) => Ok(Self(texts(list)?.into_iter().map(|Text(text)| text).collect())),
        one => text(one).map(|Text(one)| Self(vec![one])),
    };
    Event, "Event", {
        "type": ["string", "object"],
        "properties": { "when": { "type": "string" }, "stop": { "type": "boolean" } },
        "required": ["when"],
        "additionalProperties": false
    }, |value| match value {
        Value::Table(table) => {
            table.try_into().map(Self).map_err(|error| error.message().to_owned())
        }
        one => Ok(Self(EventTable { when: text(one)?, stop: false })),
    };
}

/// Formats a number for a reader, with about four significant digits.
pub fn digits(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        return "0".into();
    }
    if !(1e-3..1e5).contains(&size) {
        return format!("{value:.3e}");
    }
    // None of large numbers: the conversion ends at zero.
    let decimals = (3.0 - casimir::real::elementary::log10(size).floor()) as usize;
    let text = format!("{value:.decimals$}");
    // 0.2 and not 0.2000.
    match decimals {
        0 => text,
        _ => text.trim_end_matches('0').trim_end_matches('.').into(),
    }
}
