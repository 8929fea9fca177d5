//! Short mathematical labels: a base with an optional subscript and superscript, and words behind
//! it.
//!
//! One notation serves the figures and the page: `2^-5` is 2⁻⁵, `y2^2` is y₂², `cos y3` is cos y₃.
//! Digits that follow a letter are an index; what follows `^` is an exponent.

/// Size of an index or exponent relative to the base.
pub(crate) const SCRIPT_SIZE: f64 = 0.74;

/// A base with an optional subscript and superscript.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Label {
    /// What stands on the line.
    pub base: String,
    /// The index, possibly empty.
    pub index: String,
    /// The exponent, possibly empty.
    pub exponent: String,
    /// Plain words behind all of it, possibly empty.
    pub tail: String,
}

impl Label {
    /// Reads `base`, `base^exponent`, or either with an index of digits after the last letter of
    /// the base.
    pub fn new(notation: &str) -> Self {
        let (base, exponent) = notation.split_once('^').unwrap_or((notation, ""));
        let stem = base.trim_end_matches(|c: char| c.is_ascii_digit());
        let end = if stem.ends_with(char::is_alphabetic) { stem.len() } else { base.len() };
        let [base, index, exponent] =
            [&base[..end], &base[end..], exponent].map(|text| text.replace('-', "−"));
        Self { base, index, exponent, tail: String::new() }
    }

    /// Plain words, in which digits and hyphens stay what they are.
    pub fn words(text: &str) -> Self {
        Self { base: text.into(), ..Self::default() }
    }

    /// Estimated width in units of its font size.
    pub fn width(&self) -> f64 {
        width(&self.base)
            + SCRIPT_SIZE * (width(&self.index) + width(&self.exponent))
            + width(&self.tail)
    }
}

/// Upper estimate of the width of `text` in units of the font size.
///
/// An SVG names only a generic family, so the true width is unknown until it is shown; the estimate
/// follows the widest of the common sans-serif fonts.
fn width(text: &str) -> f64 {
    text.chars()
        .map(|c| match c {
            c if "ijltfr .,:()|/".contains(c) => 0.4,
            c if "mwMW−≤".contains(c) => 0.86,
            _ => 0.6,
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(notation: &str) -> (String, String, String) {
        let label = Label::new(notation);
        (label.base, label.index, label.exponent)
    }

    fn owned(base: &str, index: &str, exponent: &str) -> (String, String, String) {
        (base.into(), index.into(), exponent.into())
    }

    #[test]
    fn indices_follow_letters_and_exponents_follow_carets() {
        assert_eq!(parts("y2^2"), owned("y", "2", "2"));
        assert_eq!(parts("cos y3"), owned("cos y", "3", ""));
        assert_eq!(parts("2^-14"), owned("2", "", "−14"));
        assert_eq!(parts("y(T)"), owned("y(T)", "", ""));
        assert_eq!(parts("0.25"), owned("0.25", "", ""));
        assert_eq!(parts(""), owned("", "", ""));
    }

    #[test]
    fn scripts_are_narrower_than_the_base() {
        let (base, script) = (Label::new("y22"), Label::words("y22"));
        assert!(base.width() < script.width());
    }
}
