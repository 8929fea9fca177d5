//! The text of a scene, and errors that point into it.

use std::{
    fmt::{self, Display},
    ops::Range,
};

use casimir::formula::{Excerpt, FormulaError, line_column};
use toml::Spanned;

use super::values::Text;

/// A file with a scene.
#[derive(Clone, Debug)]
pub struct Source {
    /// Its name as the user gave it.
    pub name: String,
    /// Its content.
    pub text: String,
}

/// What is wrong with a scene, where, and what would be right.
#[derive(Clone, Debug)]
pub struct SceneError {
    file: String,
    place: Option<(usize, usize, Excerpt)>,
    message: String,
}

/// A result of reading a scene.
pub type Read<T> = Result<T, SceneError>;

impl Source {
    /// Something wrong at a place, in bytes of the text.
    pub fn error(&self, span: Range<usize>, message: impl Display) -> SceneError {
        // The end of the text may be meant.
        let start = floor(&self.text, span.start.min(self.text.len()));
        let span = start..floor(&self.text, span.end.clamp(start, self.text.len()));
        let (line, column) = line_column(&self.text, span.start);
        let place = Some((line, column, Excerpt::new(&self.text, &span)));
        SceneError { file: self.name.clone(), place, message: message.to_string() }
    }

    /// Something wrong with the whole.
    pub fn error_of_all(&self, message: impl Display) -> SceneError {
        SceneError { file: self.name.clone(), place: None, message: message.to_string() }
    }

    /// Something wrong with a formula, at its place in the file.
    pub fn formula_error(&self, formula: &Spanned<Text>, error: &FormulaError) -> SceneError {
        let place = self.place_in(formula, &error.span);
        match error.unknown_name.as_deref() {
            Some("t") => {
                self.error(place, "unknown name `t`: time is known in the rate of damping only")
            }
            _ => self.error(place, &error.message),
        }
    }

    /// A place in a formula, in bytes of the file; the whole formula if it is written with escapes.
    pub fn place_in(&self, formula: &Spanned<Text>, span: &Range<usize>) -> Range<usize> {
        let (whole, text) = (formula.span(), &formula.get_ref().0);
        match self.text.get(whole.clone()).and_then(|written| written.find(&**text)) {
            Some(before) => {
                let start = whole.start + before;
                start + span.start..start + span.end
            }
            None => whole,
        }
    }
}

/// The last place at or before a byte at which a character begins.
fn floor(text: &str, byte: usize) -> usize {
    (0..=byte).rev().find(|&byte| text.is_char_boundary(byte)).unwrap_or(0)
}

impl Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, place, message } = self;
        match place {
            Some((line, column, excerpt)) => {
                write!(f, "{file}, line {line}, column {column}: {message}\n{excerpt}")
            }
            None => write!(f, "{file}: {message}"),
        }
    }
}

impl std::error::Error for SceneError {}
