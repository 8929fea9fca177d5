//! The text of a scene, and errors that point into it.

use std::{fmt::Display, ops::Range, sync::Arc};

use casimir::{
    formula::{Formula, FormulaError, Names, excerpt},
    schemes::Device,
};

use crate::{At, Text};

/// A file with a scene.
#[derive(Clone, Debug)]
pub struct Source {
    /// Name of the file as the user gave it.
    pub name: String,
    /// Content of the file.
    pub text: String,
    /// Initial states given by a program, in the place of the file that the text names.
    pub states: Option<Arc<Vec<Vec<f64>>>>,
    /// A machine that advances paths where it can, with the bits of this one.
    pub device: Option<Arc<dyn Device>>,
}

/// An error in a scene: the mistake, its place, and the remedy.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{message}")]
pub struct SceneError {
    message: String,
    /// Place of the error, in bytes of the text.
    pub place: Option<Range<usize>>,
}

/// An error in a scene before its source is named: see [`Source::located`].
#[derive(Debug)]
pub struct Wrong {
    /// The mistake and the remedy.
    pub message: String,
    place: Option<Range<usize>>,
    /// Text of the formula at the place, and the part of it that is meant.
    part: Option<(String, Range<usize>)>,
}

/// Result of reading a part of a scene.
pub type Read<T> = Result<T, Wrong>;

impl Wrong {
    /// An error at a place, or about the whole scene.
    pub fn new(place: impl Into<Option<Range<usize>>>, message: impl Display) -> Self {
        Self { message: message.to_string(), place: place.into(), part: None }
    }

    /// This error, with another message if the part of the formula that is meant is one of `names`.
    pub fn instead(self, names: &[&str], message: &str) -> Self {
        let part = self.part.as_ref().and_then(|(text, span)| text.get(span.clone()));
        match part.is_some_and(|part| names.contains(&part)) {
            true => Self { message: message.into(), ..self },
            false => self,
        }
    }

    /// An error in a part of a formula.
    fn in_formula(formula: &At<Text>, error: &FormulaError, message: impl Display) -> Self {
        let part = Some((formula.0.clone(), error.span.clone()));
        Self { part, ..Self::new(formula, message) }
    }

    /// An error in a formula, with the message of its parser.
    pub fn formula(formula: &At<Text>, error: &FormulaError) -> Self {
        let message = match &*error.message {
            "unknown function `integral`" | "unknown function `average`" => {
                "this is an observable of its own: give it a name, a = \"integral(v)\", and \
                 use that"
            }
            "`E` is no vector" | "unknown function `E`" => {
                "`E` is neither a vector nor a function: write what it is of, x for E[x]; \
                 expectations are taken of that"
            }
            _ if error.unknown_name.as_deref() == Some("t") => {
                "unknown name `t`: time is known in H0, H, the rate and observables"
            }
            message => message,
        };
        Self::in_formula(formula, error, message)
    }
}

/// Returns an error at a place.
#[macro_export]
macro_rules! refuse {
    ($place:expr, $($words:tt)+) => {
        return Err($crate::Wrong::new($place, format_args!($($words)+)))
    };
}
impl Source {
    /// The text of a file.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        Self { name: name.into(), text: text.into(), states: None, device: None }
    }

    /// An error at a place, in bytes of the text, or about the whole scene.
    pub fn error(
        &self,
        place: impl Into<Option<Range<usize>>>,
        message: impl Display,
    ) -> SceneError {
        let Self { name, text, .. } = self;
        let Some(span) = place.into() else {
            return SceneError { message: format!("{name}: {message}"), place: None };
        };
        // The end of the text may be meant.
        let start = floor(text, span.start.min(text.len()));
        let span = start..floor(text, span.end.clamp(start, text.len()));
        let (line, column, excerpt) = excerpt(text, &span);
        let message = format!("{name}, line {line}, column {column}: {message}\n{excerpt}");
        SceneError { message, place: Some(span) }
    }

    /// Names this source in the error of a result. The whole formula is shown if it is written with
    /// escapes.
    pub fn located<T>(&self, read: Read<T>) -> Result<T, SceneError> {
        read.map_err(|Wrong { message, place, part }| {
            let within = place.as_ref().zip(part).and_then(|(whole, (formula, span))| {
                let start = whole.start + self.text.get(whole.clone())?.find(&formula)?;
                Some(start + span.start..start + span.end)
            });
            self.error(within.or(place), message)
        })
    }
}

impl At<Text> {
    /// Parses the formula with `names`.
    pub fn formula(&self, names: &Names) -> Read<Formula> {
        Formula::parse(&self.0, names).map_err(|error| Wrong::formula(self, &error))
    }

    /// Checks that the formula has a value at a point, which is `named`.
    pub fn demand_value(&self, formula: &Formula, point: &[f64], named: impl Display) -> Read<()> {
        formula.explain(point).map_or(Ok(()), |error| {
            let message = format!("{} at {named}", error.message);
            Err(Wrong::in_formula(self, &error, message))
        })
    }
}

/// The last place at or before a byte at which a character begins.
fn floor(text: &str, byte: usize) -> usize {
    (0..=byte).rev().find(|&byte| text.is_char_boundary(byte)).unwrap_or(0)
}
