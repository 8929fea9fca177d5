//! Subscripts and superscripts in SVG text.
//!
//! plotters draws plain text only. Scripts pass through it between marks from the private use area
//! of Unicode, which become `tspan` elements in the finished document: so the browser places them
//! by the true width of the base, whatever the font.

use crate::label::{Label, SCRIPT_SIZE};

/// Marks that open an index, an exponent, an exponent behind an index, and text that returns to the
/// line from an index or from an exponent; and the one that closes them.
const INDEX: char = '\u{e000}';
const EXPONENT: char = '\u{e001}';
const EXPONENT_BEHIND: char = '\u{e002}';
const RAISED: char = '\u{e003}';
const LOWERED: char = '\u{e004}';
const CLOSE: char = '\u{e005}';

/// How far an index sinks and an exponent rises, in units of their own font size.
const SINK: f64 = 0.28;
const RISE: f64 = 0.5;

/// The text of a label with its scripts between marks.
pub fn marked(label: &Label) -> String {
    let script = |open: char, text: &str| match text {
        "" => String::new(),
        text => format!("{open}{}{CLOSE}", unmarked(text)),
    };
    let tail = match (label.index.as_str(), label.exponent.as_str(), label.tail.as_str()) {
        (_, _, "") => String::new(),
        ("", "", text) => unmarked(text),
        (_, "", text) => format!("{RAISED}{}{CLOSE}", unmarked(text)),
        (_, _, text) => format!("{LOWERED}{}{CLOSE}", unmarked(text)),
    };
    let exponent = if label.index.is_empty() { EXPONENT } else { EXPONENT_BEHIND };
    format!(
        "{}{}{}{tail}",
        unmarked(&label.base),
        script(INDEX, &label.index),
        script(exponent, &label.exponent)
    )
}

/// Text without marks of its own, which would break the document.
fn unmarked(text: &str) -> String {
    text.replace([INDEX, EXPONENT, EXPONENT_BEHIND, RAISED, LOWERED, CLOSE], "\u{fffd}")
}

/// Replaces the marks in a document.
pub fn typeset(svg: &str) -> String {
    let open = |shift: f64| {
        let percent = 100.0 * SCRIPT_SIZE;
        format!("<tspan dy=\"{shift:.2}em\" font-size=\"{percent}%\">")
    };
    let back = |shift: f64| format!("<tspan dy=\"{:.3}em\">", shift * SCRIPT_SIZE);
    svg.replace(INDEX, &open(SINK))
        .replace(EXPONENT, &open(-RISE))
        // A shift holds for all that follows, so this one has to make up for the index.
        .replace(EXPONENT_BEHIND, &open(-RISE - SINK))
        // The tail has the size of the base, the shift before it was in units of the script.
        .replace(RAISED, &back(-SINK))
        .replace(LOWERED, &back(RISE))
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
    fn what_follows_a_script_is_back_on_the_line() {
        let tail = |notation| typeset(&marked(&Label::new(notation).with_tail(": 1")));
        assert_eq!(tail("y"), "y: 1");
        assert!(tail("y2").ends_with("2</tspan><tspan dy=\"-0.207em\">: 1</tspan>"));
        assert!(tail("y2^2").ends_with("2</tspan><tspan dy=\"0.370em\">: 1</tspan>"));
    }

    #[test]
    fn foreign_marks_are_harmless() {
        let label = Label::words("a\u{e000}b");
        assert_eq!(typeset(&marked(&label)), "a\u{fffd}b");
    }
}
