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
    /// Base of the label, on the line.
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

    /// Creates a label of plain words, in which digits and hyphens stay unchanged.
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

    #[test]
    fn indices_follow_letters_and_exponents_follow_carets() {
        for (notation, parts) in [
            ("y2^2", ["y", "2", "2"]),
            ("cos y3", ["cos y", "3", ""]),
            ("2^-14", ["2", "", "−14"]),
            ("y(T)", ["y(T)", "", ""]),
            ("0.25", ["0.25", "", ""]),
            ("", ["", "", ""]),
        ] {
            let label = Label::new(notation);
            assert_eq!([label.base, label.index, label.exponent], parts, "{notation}");
        }
        // Scripts are narrower than the base.
        assert!(Label::new("y22").width() < Label::words("y22").width());
    }
}
