//! Errors in a text: the mistake and its place.

use std::ops::Range;

/// A text that is not a formula, or a formula without a value: what is wrong, where, and what would
/// be right.
///
/// It shows the line of the text with carets under the place. Lines and columns are counted from 1,
/// columns in characters.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("line {line}, column {column}: {message}\n{excerpt}")]
pub struct FormulaError {
    /// Description of the mistake.
    pub message: String,
    /// Unknown name, if that is the mistake.
    pub unknown_name: Option<String>,
    /// The place, in bytes of the text.
    pub span: Range<usize>,
    /// The line of the place.
    pub line: usize,
    /// The column of the place in its line.
    pub column: usize,
    /// The line with carets.
    pub(crate) excerpt: String,
}

impl FormulaError {
    pub(crate) fn new(message: impl Into<String>, text: &str, span: Range<usize>) -> Self {
        let (line, column, excerpt) = excerpt(text, &span);
        Self { message: message.into(), unknown_name: None, span, line, column, excerpt }
    }
}

/// The first characters of a name.
pub(crate) fn short(name: &str) -> String {
    match name.char_indices().nth(AFTER) {
        Some((end, _)) => format!("{}…", &name[..end]),
        None => name.to_owned(),
    }
}

/// Characters of a line that are shown before and after the start of a place.
const BEFORE: usize = 50;
const AFTER: usize = 30;

/// Line and column of the first byte of `span`, counted from 1, and this line with carets under the
/// place: for messages about other files than formulas, too. Columns are in characters.
///
/// ```
/// let text = "steps = 512\nuntil = -2";
/// let (line, column, excerpt) = formula::excerpt(text, &(20..22));
/// assert_eq!((line, column), (2, 9));
/// assert_eq!(excerpt, "  until = -2\n          ^^");
/// ```
#[must_use]
pub fn excerpt(text: &str, span: &Range<usize>) -> (usize, usize, String) {
    let start = text[..span.start].rfind('\n').map_or(0, |newline| newline + 1);
    let end = text[span.start..].find('\n').map_or(text.len(), |at| span.start + at);
    let before = text[start..span.start].chars().count();
    let skipped = before.saturating_sub(BEFORE);
    let mut line = String::from(if skipped > 0 { "…" } else { "" });
    let mut rest = text[start..end].chars().skip(skipped);
    let shown = rest.by_ref().take(before - skipped + AFTER);
    line.extend(shown.map(|c| if c.is_control() { ' ' } else { c }));
    if rest.next().is_some() {
        line.push('…');
    }
    let marked = text[span.start..span.end.min(end).max(span.start)].chars().count();
    let carets = marked.clamp(1, AFTER);
    let blank = before - skipped + usize::from(skipped > 0);
    let number = text[..start].matches('\n').count() + 1;
    (number, before + 1, format!("  {line}\n  {:blank$}{:^<carets$}", "", ""))
}
