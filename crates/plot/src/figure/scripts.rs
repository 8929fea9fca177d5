//! Subscripts and superscripts in SVG text: the browser places them by the true width of the base,
//! whatever the font.

use crate::{
    escape,
    label::{Label, SCRIPT_SIZE},
};

/// How far an index stands below the line and an exponent above, in units of the script's size.
const SINK: f64 = 0.28;
const RISE: f64 = 0.5;

/// The content of a `text` element.
pub fn markup(label: &Label) -> String {
    let mut markup = escape(&label.base);
    // A shift holds for all that follows: each part is moved from where the one before it stands.
    let mut height = 0.0;
    for (text, level, size) in [
        (&label.index, -SINK * SCRIPT_SIZE, SCRIPT_SIZE),
        (&label.exponent, RISE * SCRIPT_SIZE, SCRIPT_SIZE),
        (&label.tail, 0.0, 1.0),
    ] {
        if !text.is_empty() {
            let (shift, percent, text) = ((height - level) / size, 100.0 * size, escape(text));
            markup +=
                &format!("<tspan dy=\"{shift:.2}em\" font-size=\"{percent}%\">{text}</tspan>");
            height = level;
        }
    }
    markup
}
