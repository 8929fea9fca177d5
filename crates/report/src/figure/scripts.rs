//! Subscripts and superscripts in SVG text: the browser places them by the true width of the base,
//! whatever the font.

use crate::escape::escape;
use crate::label::{Label, SCRIPT_SIZE};

/// How far an index sinks and an exponent rises, in units of their own font size.
const SINK: f64 = 0.28;
const RISE: f64 = 0.5;

/// The content of a text element for a label.
pub fn markup(label: &Label) -> String {
    // A shift holds for all that follows: each part is moved from where the one before it stands.
    let mut height = 0.0;
    let mut script = |text: &str, level: f64| {
        if text.is_empty() {
            return String::new();
        }
        let (shift, size) = (level - height, 100.0 * SCRIPT_SIZE);
        height = level;
        format!("<tspan dy=\"{shift:.2}em\" font-size=\"{size}%\">{}</tspan>", escape(text))
    };
    let scripts = [script(&label.index, SINK), script(&label.exponent, -RISE)].concat();
    let mut tail = escape(&label.tail);
    if height != 0.0 && !tail.is_empty() {
        // The tail has the size of the base; the shift before it was in units of the script.
        tail = format!("<tspan dy=\"{:.3}em\">{tail}</tspan>", -height * SCRIPT_SIZE);
    }
    format!("{}{scripts}{tail}", escape(&label.base))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripts_become_elements() {
        assert_eq!(
            markup(&Label::new("y2^2")),
            "y<tspan dy=\"0.28em\" font-size=\"74%\">2</tspan>\
             <tspan dy=\"-0.78em\" font-size=\"74%\">2</tspan>"
        );
        assert_eq!(markup(&Label::words("a<b")), "a&lt;b");
    }

    #[test]
    fn what_follows_a_script_is_back_on_the_line() {
        let tail = |notation| markup(&Label::new(notation).with_tail(": 1"));
        assert_eq!(tail("y"), "y: 1");
        assert!(tail("y2").ends_with("2</tspan><tspan dy=\"-0.207em\">: 1</tspan>"));
        assert!(tail("y2^2").ends_with("2</tspan><tspan dy=\"0.370em\">: 1</tspan>"));
    }
}
