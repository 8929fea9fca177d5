//! What is wrong with a text, and where.

use std::{
    fmt::{self, Display},
    ops::Range,
};

use crate::parse::{MAX_BYTES, MAX_DEPTH};

/// A text that is not a formula: what is wrong, where, and what would be right.
///
/// [`Display`] shows the line of the text with carets under the place. Lines and columns are
/// counted from 1, columns in characters.
#[derive(Clone, Debug, PartialEq)]
pub struct FormulaError {
    /// What is wrong.
    pub kind: FormulaErrorKind,
    /// The place, in bytes of the text.
    pub span: Range<usize>,
    /// The line of the place.
    pub line: usize,
    /// The column of the place in its line.
    pub column: usize,
    excerpt: Box<Excerpt>,
}

/// What is wrong with a text.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FormulaErrorKind {
    /// There is nothing but white space.
    #[error("the formula is empty: write a number or an expression")]
    Empty,
    /// The text is longer than [`MAX_BYTES`].
    #[error("the formula has {bytes} bytes, and at most {MAX_BYTES} are allowed")]
    TooLong {
        /// Its length.
        bytes: usize,
    },
    /// Brackets, signs and powers are nested deeper than [`MAX_DEPTH`].
    #[error("brackets, signs and powers are nested deeper than {MAX_DEPTH}")]
    TooDeep,
    /// A character that no formula has.
    #[error("unexpected character `{}`{}", found.escape_debug(), Hint(": write ", instead))]
    UnexpectedCharacter {
        /// The character.
        found: char,
        /// What may have been meant.
        instead: Option<&'static str>,
    },
    /// An operand is missing before this place.
    #[error("a number, a name or a bracket is missing {}", Before(before))]
    MissingOperand {
        /// The token at this place; none at the end of the text.
        before: Option<String>,
    },
    /// An operator is missing between two operands.
    #[error("an operator is missing: write {write}")]
    MissingOperator {
        /// What would be right, if a product is meant.
        write: String,
    },
    /// A bracket is not closed.
    #[error("this bracket is not closed: `)` is missing")]
    NotClosed,
    /// A bracket was not opened.
    #[error("this bracket was not opened: remove it or write `(` before it")]
    NotOpened,
    /// A comma outside of the arguments of a function.
    #[error("a comma stands only between arguments of min and max; decimals have a point")]
    Comma,
    /// An operator of another language.
    #[error("unknown operator: write {write}")]
    UnknownOperator {
        /// What would be right.
        write: &'static str,
    },
    /// A name that nobody gave.
    #[error("unknown name `{}`{}", Short(name), Hint("; the nearest is ", nearest))]
    UnknownName {
        /// The name.
        name: String,
        /// The nearest known name.
        nearest: Option<String>,
    },
    /// A function that does not exist.
    #[error("unknown function `{}`{}", Short(name), Hint("; the nearest is ", nearest))]
    UnknownFunction {
        /// Its name.
        name: String,
        /// The nearest known function.
        nearest: Option<String>,
    },
    /// A variable or parameter with arguments.
    #[error("`{0}` is no function: write {0}*(…) for a product", Short(name))]
    NotAFunction {
        /// The name.
        name: String,
    },
    /// A function without brackets.
    #[error("`{function}` is a function: write {function}(…)")]
    NoArguments {
        /// Its name.
        function: String,
    },
    /// A function with another number of arguments.
    #[error("`{function}` takes {expected} {}, got {found}", arguments(*expected))]
    WrongArguments {
        /// Its name.
        function: String,
        /// How many it takes.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// A quotient with the constant zero below.
    #[error("division by zero")]
    DivisionByZero,
    /// A number too large for floating point, or a constant that is not finite, as ln(−1).
    #[error("this is not a finite number but {value}")]
    NotFinite {
        /// Its value.
        value: f64,
    },
}

fn arguments(count: usize) -> &'static str {
    if count == 1 { "argument" } else { "arguments" }
}

/// `nearest` after some words, if there is one.
struct Hint<'a, S>(&'static str, &'a Option<S>);

impl<S: Display> Display for Hint<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.1 {
            Some(nearest) => write!(f, "{}`{nearest}`", self.0),
            None => Ok(()),
        }
    }
}

/// The first characters of a name.
struct Short<'a>(&'a str);

impl Display for Short<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0.char_indices().nth(Excerpt::AFTER) {
            Some((end, _)) => write!(f, "{}…", &self.0[..end]),
            None => f.write_str(self.0),
        }
    }
}

struct Before<'a>(&'a Option<String>);

impl Display for Before<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Some(token) => write!(f, "before `{}`", Short(token)),
            None => f.write_str("at the end"),
        }
    }
}

impl FormulaError {
    pub(crate) fn new(kind: FormulaErrorKind, text: &str, span: Range<usize>) -> Self {
        let (line, column) = line_column(text, span.start);
        let excerpt = Box::new(Excerpt::new(text, &span));
        Self { kind, span, line, column, excerpt }
    }
}

impl Display for FormulaError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { kind, line, column, excerpt, .. } = self;
        write!(f, "line {line}, column {column}: {kind}\n{excerpt}")
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
        let (skipped, cut) = match before.checked_sub(Self::BEFORE) {
            None | Some(0) => (0, false),
            Some(skipped) => (skipped, true),
        };
        let mut line = String::from(if cut { "…" } else { "" });
        let shown = before - skipped + Self::AFTER;
        let mut rest = text[start..end].chars().skip(skipped);
        line.extend(rest.by_ref().take(shown).map(|c| if c.is_control() { ' ' } else { c }));
        if rest.next().is_some() {
            line.push('…');
        }
        let marked = text[span.start..span.end.min(end).max(span.start)].chars().count();
        let carets = marked.clamp(1, Self::AFTER);
        Self { line, before: before - skipped + usize::from(cut), carets }
    }
}

impl Display for Excerpt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "  {}\n  {:before$}{:^<carets$}",
            self.line,
            "",
            "",
            before = self.before,
            carets = self.carets
        )
    }
}
