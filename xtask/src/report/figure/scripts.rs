//! Subscripts and superscripts in SVG text.
//!
//! plotters draws plain text only. Scripts pass through it between marks from the private use area of Unicode,
//! which become `tspan` elements in the finished document: so the browser places them by the true width of the
//! base, whatever the font.

use crate::report::label::{Label, SCRIPT_SIZE};

/// Marks that open an index, an exponent, and an exponent behind an index; and the one that closes them.
const INDEX: char = '\u{e000}';
const EXPONENT: char = '\u{e001}';
const EXPONENT_BEHIND: char = '\u{e002}';
const CLOSE: char = '\u{e003}';

/// How far an index sinks and an exponent rises, in units of their own font size.
const SINK: f64 = 0.28;
const RISE: f64 = 0.5;

/// The text of a label with its scripts between marks.
pub fn marked(label: &Label) -> String {
    let script = |open: char, text: &str| match text {
        "" => String::new(),
        text => format!("{open}{}{CLOSE}", unmarked(text)),
    };
    let exponent = if label.index.is_empty() { EXPONENT } else { EXPONENT_BEHIND };
    format!("{}{}{}", unmarked(&label.base), script(INDEX, &label.index), script(exponent, &label.exponent))
}

/// Text without marks of its own, which would break the document.
fn unmarked(text: &str) -> String {
    text.replace([INDEX, EXPONENT, EXPONENT_BEHIND, CLOSE], "\u{fffd}")
}

/// Replaces the marks in a document.
pub fn typeset(svg: &str) -> String {
    let open = |shift: f64| {
        let percent = 100.0 * SCRIPT_SIZE;
        format!("<tspan dy=\"{shift:.2}em\" font-size=\"{percent}%\">")
    };
    svg.replace(INDEX, &open(SINK))
        .replace(EXPONENT, &open(-RISE))
        // A shift holds for all that follows, so this one has to make up for the index.
        .replace(EXPONENT_BEHIND, &open(-RISE - SINK))
        .replace(CLOSE, "</tspan>")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripts_become_elements() {
        let text = typeset(&marked(&Label::new("y2^2")));
        assert_eq!(
            text,
            "y<tspan dy=\"0.28em\" font-size=\"74%\">2</tspan>\
             <tspan dy=\"-0.78em\" font-size=\"74%\">2</tspan>"
        );
        assert_eq!(typeset(&marked(&Label::new("sexp"))), "sexp");
    }

    #[test]
    fn foreign_marks_are_harmless() {
        let label = Label::words("a\u{e000}b");
        assert_eq!(typeset(&marked(&label)), "a\u{fffd}b");
    }
}
