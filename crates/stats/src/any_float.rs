//! Floating-point numbers that may not be finite, in formats that have no such numbers: a finite
//! one is a number, any other the text `inf`, `-inf` or `NaN`.

use serde::{Deserialize, Deserializer, Serializer, de::Error};

pub fn serialize<S: Serializer>(x: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    if x.is_finite() {
        serializer.serialize_f64(*x)
    } else {
        serializer.serialize_str(&x.to_string())
    }
}

pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Read {
        Number(f64),
        Text(String),
    }
    match Read::deserialize(deserializer)? {
        Read::Number(x) => Ok(x),
        Read::Text(text) => {
            text.parse().map_err(|_| D::Error::custom(format!("expected a number, got {text:?}")))
        }
    }
}
