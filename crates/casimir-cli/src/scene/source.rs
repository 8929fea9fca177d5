//! The text of a scene, and errors that point into it.

use std::{fmt::Display, ops::Range, sync::Arc};

use casimir::formula::{Formula, FormulaError, Names, excerpt};

use super::values::{At, Text};

/// A file with a scene.
#[derive(Clone, Debug)]
pub struct Source {
    /// Its name as the user gave it.
    pub name: String,
    /// Its content.
    pub text: String,
    /// Initial states that a program has, in the place of the file that the text names.
    pub states: Option<Arc<Vec<Vec<f64>>>>,
}

/// What is wrong with a scene, where, and what would be right.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{message}")]
pub struct SceneError {
    message: String,
    /// Where, in bytes of the text.
    pub place: Option<Range<usize>>,
}

/// A result of reading a scene.
pub type Read<T> = Result<T, SceneError>;

/// Returns an error of a source, or of parameters, at a place.
macro_rules! refuse {
    ($of:expr, $place:expr, $($words:tt)+) => {
        return Err($of.error($place, format_args!($($words)+)))
    };
}
pub(crate) use refuse;

impl Source {
    /// Something wrong at a place, in bytes of the text, or with the whole.
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

    /// A formula in names.
    pub fn formula(&self, text: &At<Text>, names: &Names) -> Read<Formula> {
        Formula::parse(&text.0, names).map_err(|error| self.formula_error(text, &error))
    }

    /// Something wrong with a formula, at its place in the file.
    pub fn formula_error(&self, formula: &At<Text>, error: &FormulaError) -> SceneError {
        let is_mean = |word: &str| error.message == format!("unknown function `{word}`");
        let message = match error.unknown_name.as_deref() {
            _ if is_mean("integral") || is_mean("average") => {
                "this is an observable of its own: give it a name, a = \"integral(v)\", and \
                 use that"
            }
            Some("t") => "unknown name `t`: time is known in H0, H, the rate and observables",
            _ => &error.message,
        };
        self.error_in(formula, error, message)
    }

    /// The same in other words. The whole formula is shown if it is written with escapes.
    pub fn error_in(
        &self,
        formula: &At<Text>,
        error: &FormulaError,
        message: impl Display,
    ) -> SceneError {
        let (whole, text, span) = (formula.span(), &formula.0, &error.span);
        let written = self.text.get(whole.clone()).and_then(|written| written.find(&**text));
        let place = written.map_or(whole.clone(), |before| {
            let start = whole.start + before;
            start + span.start..start + span.end
        });
        self.error(place, message)
    }
}

/// The last place at or before a byte at which a character begins.
fn floor(text: &str, byte: usize) -> usize {
    (0..=byte).rev().find(|&byte| text.is_char_boundary(byte)).unwrap_or(0)
}
