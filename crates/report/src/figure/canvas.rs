//! Lines, markers and text on an SVG page, measured in CSS pixels at column width.

use super::{
    look::{Look, Marker},
    scripts::markup,
    stroke::{Color, Position, Stroke},
};
use crate::{escape::escape, label::Label};

/// Ink of axes and text.
pub const INK: Color = "#222222";
/// Ink of grid lines.
pub const FAINT: Color = "#E2E2E2";
/// Ink of reference lines.
pub const GREY: Color = "#696969";
const PAPER: Color = "#FFFFFF";

/// Coordinates are integers on a grid that is so many times finer than a pixel.
const GRID: f64 = 20.0;

/// Pixels to a centimetre, by the definition of the CSS pixel.
const PER_CENTIMETRE: f64 = 96.0 / 2.54;

/// Length of a dash in pixels.
const DASH: f64 = 4.0;
/// Length of a gap in pixels; round line ends shorten what is seen of it.
const GAP: f64 = 3.2;

/// Which point of a text lies at the position given.
pub enum Align {
    /// Its left end.
    Left,
    /// Its middle.
    Middle,
    /// Its right end.
    Right,
    /// Its middle, and the text reads upwards.
    Upward,
}

/// A page to draw on.
pub struct Canvas {
    body: String,
}

/// Draws a page of the given size with `draw` and returns it as a stand-alone SVG document.
///
/// `title` is what a screen reader says in place of the picture.
pub fn page((width, height): (f64, f64), title: &str, draw: impl FnOnce(&mut Canvas)) -> String {
    let mut canvas = Canvas { body: String::new() };
    draw(&mut canvas);
    // With mitred joints a noisy curve would turn into needles.
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" width=\"{:.2}cm\" \
         height=\"{:.2}cm\" viewBox=\"0 0 {} {}\" stroke-linejoin=\"round\" \
         stroke-linecap=\"round\">\n<title>{}</title>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{}</svg>\n",
        width / PER_CENTIMETRE,
        height / PER_CENTIMETRE,
        grid(width),
        grid(height),
        escape(title),
        canvas.body
    )
}

fn grid(length: f64) -> i32 {
    (length * GRID).round() as i32
}

fn list(points: impl Iterator<Item = Position>) -> String {
    points.map(|(x, y)| format!("{},{}", grid(x), grid(y))).collect::<Vec<_>>().join(" ")
}

impl Canvas {
    /// A line through `points`.
    pub fn polyline(&mut self, points: &[Position], stroke: Stroke) {
        if points.len() < 2 {
            return;
        }
        let Stroke { color, width, opacity, dashed } = stroke;
        let dashes = match dashed {
            true => format!(" stroke-dasharray=\"{} {}\"", grid(DASH), grid(GAP)),
            false => String::new(),
        };
        self.body += &format!(
            "<polyline fill=\"none\" opacity=\"{opacity}\" stroke=\"{color}\" \
             stroke-width=\"{}\"{dashes} points=\"{}\"/>\n",
            grid(width),
            list(points.iter().copied())
        );
    }

    /// A marker; a hollow one shows the paper inside.
    pub fn marker(&mut self, at: Position, look: Look, radius: f64, hollow: bool) {
        let shape = match outline(look.marker) {
            [] => {
                let (x, y, r) = (grid(at.0), grid(at.1), grid(radius));
                format!("circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\"")
            }
            corners => {
                let corners = corners.iter().map(|(x, y)| (at.0 + radius * x, at.1 + radius * y));
                format!("polygon points=\"{}\"", list(corners))
            }
        };
        let paint = if hollow {
            format!("fill=\"{PAPER}\" stroke=\"{}\" stroke-width=\"{}\"", look.color, grid(1.1))
        } else {
            format!("fill=\"{}\"", look.color)
        };
        self.body += &format!("<{shape} {paint}/>\n");
    }

    /// A label on one line, centred vertically at `at`; one that reads upwards is centred both
    /// ways.
    pub fn label(&mut self, label: &Label, at: Position, size: f64, align: Align) {
        let (x, y, size) = (grid(at.0), grid(at.1), grid(size));
        let (anchor, turn) = match align {
            Align::Left => ("start", 0),
            Align::Middle => ("middle", 0),
            Align::Right => ("end", 0),
            Align::Upward => ("middle", 270),
        };
        self.body += &format!(
            "<text x=\"{x}\" y=\"{y}\" dy=\"0.5ex\" text-anchor=\"{anchor}\" \
             transform=\"rotate({turn}, {x}, {y})\" font-family=\"sans-serif\" \
             font-size=\"{size}\" fill=\"{INK}\">{}</text>\n",
            markup(label)
        );
    }
}

/// Corners of a marker of radius one, none of a circle. The areas are about that of the circle, so
/// that no curve looks more important than another.
fn outline(marker: Marker) -> &'static [Position] {
    match marker {
        Marker::Circle => &[],
        Marker::Square => &[(-0.89, -0.89), (0.89, -0.89), (0.89, 0.89), (-0.89, 0.89)],
        Marker::Diamond => &[(0.0, -1.3), (1.3, 0.0), (0.0, 1.3), (-1.3, 0.0)],
        Marker::Triangle => &[(0.0, -1.4), (1.25, 0.85), (-1.25, 0.85)],
        Marker::Wedge => &[(0.0, 1.4), (1.25, -0.85), (-1.25, -0.85)],
        Marker::Star => &[
            (0.0, -1.5),
            (0.45, -0.45),
            (1.5, 0.0),
            (0.45, 0.45),
            (0.0, 1.5),
            (-0.45, 0.45),
            (-1.5, 0.0),
            (-0.45, -0.45),
        ],
    }
}
