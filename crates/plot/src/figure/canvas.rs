//! Lines, markers and text on an SVG page, measured in CSS pixels at column width.

use super::{
    look::Look,
    scripts::markup,
    stroke::{Color, Position, Stroke},
};
use crate::{escape, label::Label};

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
#[derive(Default)]
pub struct Canvas {
    elements: Vec<String>,
}

fn grid(length: f64) -> i32 {
    (length * GRID).round() as i32
}

fn list(points: impl Iterator<Item = Position>) -> String {
    points.map(|(x, y)| format!("{},{}", grid(x), grid(y))).collect::<Vec<_>>().join(" ")
}

impl Canvas {
    /// The page of the given size as a stand-alone SVG document. `title` is what a screen reader
    /// says in place of the picture.
    pub fn page(self, (width, height): (f64, f64), title: &str) -> String {
        let [wide, high] = [width, height].map(|length| length / PER_CENTIMETRE);
        let size = format!(r#"width="{wide:.2}cm" height="{high:.2}cm""#);
        let view = format!(r#"viewBox="0 0 {} {}""#, grid(width), grid(height));
        // With mitred joints a noisy curve would turn into needles.
        let joints = r#"stroke-linejoin="round" stroke-linecap="round""#;
        format!(
            r##"<svg xmlns="http://www.w3.org/2000/svg" role="img" {size} {view} {joints}>
<title>{}</title>
<rect width="100%" height="100%" fill="#fff"/>
{}
</svg>
"##,
            escape(title),
            self.elements.join("\n")
        )
    }

    /// A line through `points`.
    pub fn polyline(&mut self, points: &[Position], stroke: Stroke) {
        if points.len() < 2 {
            return;
        }
        let Stroke { color, width, opacity, dashed } = stroke;
        let dashes = match dashed {
            true => format!(r#" stroke-dasharray="{} {}""#, grid(DASH), grid(GAP)),
            false => String::new(),
        };
        let (width, points) = (grid(width), list(points.iter().copied()));
        let paint = format!(r#"opacity="{opacity}" stroke="{color}" stroke-width="{width}""#);
        let line = format!(r#"<polyline fill="none" {paint}{dashes} points="{points}"/>"#);
        self.elements.push(line);
    }

    /// An area without a border.
    pub fn area(&mut self, corners: &[Position], color: Color, opacity: f64) {
        let points = list(corners.iter().copied());
        let area = format!(r#"<polygon fill="{color}" opacity="{opacity}" points="{points}"/>"#);
        self.elements.push(area);
    }

    /// A marker; a hollow one shows the paper inside.
    pub fn marker(&mut self, at: Position, look: Look, radius: f64, hollow: bool) {
        let shape = match look.marker {
            [] => {
                let (x, y, r) = (grid(at.0), grid(at.1), grid(radius));
                format!(r#"circle cx="{x}" cy="{y}" r="{r}""#)
            }
            corners => {
                let corners = corners.iter().map(|(x, y)| (at.0 + radius * x, at.1 + radius * y));
                format!(r#"polygon points="{}""#, list(corners))
            }
        };
        let (color, width) = (look.color, grid(1.1));
        let paint = match hollow {
            true => format!(r#"fill="{PAPER}" stroke="{color}" stroke-width="{width}""#),
            false => format!(r#"fill="{color}""#),
        };
        self.elements.push(format!("<{shape} {paint}/>"));
    }

    /// A label on one line, centred vertically at `at`; one that reads upwards is centred both
    /// ways.
    pub fn label(&mut self, label: &Label, at: Position, size: f64, align: Align) {
        let (x, y, size, text) = (grid(at.0), grid(at.1), grid(size), markup(label));
        let (anchor, turn) = match align {
            Align::Left => ("start", 0),
            Align::Middle => ("middle", 0),
            Align::Right => ("end", 0),
            Align::Upward => ("middle", 270),
        };
        let turn = format!(r#"transform="rotate({turn}, {x}, {y})""#);
        let place = format!(r#"x="{x}" y="{y}" dy="0.5ex" text-anchor="{anchor}" {turn}"#);
        let font = format!(r#"font-family="sans-serif" font-size="{size}" fill="{INK}""#);
        self.elements.push(format!("<text {place} {font}>{text}</text>"));
    }
}
