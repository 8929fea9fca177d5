//! What is wrong with a text, and where.

use std::{
    fmt::{self, Display},
    ops::Range,
};

/// A text that is not a formula, or a formula without a value: what is wrong, where, and what would
/// be right.
///
/// [`Display`] shows the line of the text with carets under the place. Lines and columns are
/// counted from 1, columns in characters.
#[derive(Clone, Debug, PartialEq)]
pub struct FormulaError {
    /// What is wrong.
    pub message: String,
    /// The name that is unknown, if that is what is wrong.
    pub unknown_name: Option<String>,
    /// The place, in bytes of the text.
    pub span: Range<usize>,
    /// The line of the place.
    pub line: usize,
    /// The column of the place in its line.
    pub column: usize,
    pub(crate) excerpt: Box<Excerpt>,
}

impl FormulaError {
    pub(crate) fn new(message: impl Into<String>, text: &str, span: Range<usize>) -> Self {
        let (line, column) = line_column(text, span.start);
        let excerpt = Box::new(Excerpt::new(text, &span));
        Self { message: message.into(), unknown_name: None, span, line, column, excerpt }
    }
}

impl Display for FormulaError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { message, line, column, excerpt, .. } = self;
        write!(f, "line {line}, column {column}: {message}\n{excerpt}")
    }
}

impl std::error::Error for FormulaError {}

/// Line and column of a byte of a text, counted from 1; columns in characters.
#[must_use]
pub fn line_column(text: &str, byte: usize) -> (usize, usize) {
    let before = &text[..byte];
    let start = before.rfind('\n').map_or(0, |newline| newline + 1);
    (before.matches('\n').count() + 1, before[start..].chars().count() + 1)
}

/// The first characters of a name.
pub(crate) fn short(name: &str) -> String {
    match name.char_indices().nth(Excerpt::AFTER) {
        Some((end, _)) => format!("{}…", &name[..end]),
        None => name.to_owned(),
    }
}

/// A line of a text with carets under a place, for messages about other files than formulas, too.
///
/// ```
/// let text = "steps = 512\nuntil = -2";
/// let excerpt = formula::Excerpt::new(text, &(20..22));
/// assert_eq!(excerpt.to_string(), "  until = -2\n          ^^");
/// assert_eq!(formula::line_column(text, 20), (2, 9));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Excerpt {
    line: String,
    /// Characters before the carets, and carets.
    before: usize,
    carets: usize,
}

impl Excerpt {
    /// Characters of a line that are shown before and after the start of the place.
    const BEFORE: usize = 50;
    const AFTER: usize = 30;

    /// The line of the first byte of `span`, which is in bytes of the text.
    #[must_use]
    pub fn new(text: &str, span: &Range<usize>) -> Self {
        let start = text[..span.start].rfind('\n').map_or(0, |newline| newline + 1);
        let end = text[span.start..].find('\n').map_or(text.len(), |at| span.start + at);
        let before = text[start..span.start].chars().count();
        let skipped = before.saturating_sub(Self::BEFORE);
        let mut line = String::from(if skipped > 0 { "…" } else { "" });
        let shown = before - skipped + Self::AFTER;
        let mut rest = text[start..end].chars().skip(skipped);
        line.extend(rest.by_ref().take(shown).map(|c| if c.is_control() { ' ' } else { c }));
        if rest.next().is_some() {
            line.push('…');
        }
        let marked = text[span.start..span.end.min(end).max(span.start)].chars().count();
        let carets = marked.clamp(1, Self::AFTER);
        Self { line, before: before - skipped + usize::from(skipped > 0), carets }
    }
}

impl Display for Excerpt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { line, before, carets } = self;
        write!(f, "  {line}\n  {:before$}{:^<carets$}", "", "")
    }
}
