//! Lines, markers and text on an SVG page, measured in CSS pixels at column width.

use super::*;
use crate::{escape, label::SCRIPT_SIZE};

/// A place on the page in CSS pixels, from the upper left corner.
pub type Position = (f64, f64);

/// A colour in the notation of SVG.
pub type Color = &'static str;

/// Ink of axes and text.
pub const INK: Color = "#222222";
/// Ink of grid lines.
pub const FAINT: Color = "#E2E2E2";
/// Ink of reference lines.
pub const GREY: Color = "#696969";

/// Grid points per pixel: coordinates are integers on this grid.
const GRID: f64 = 20.0;

/// Colour, width in pixels, opacity and continuity of a line.
#[derive(Clone, Copy)]
pub struct Stroke {
    pub color: Color,
    pub width: f64,
    pub opacity: f64,
    pub dashed: bool,
}

impl Stroke {
    /// Creates an opaque stroke without gaps.
    pub const fn new(color: Color, width: f64) -> Self {
        Self { color, width, opacity: 1.0, dashed: false }
    }

    /// Makes the stroke dashed.
    pub const fn dashed(self) -> Self {
        Self { dashed: true, ..self }
    }
}

/// Point of a text that lies at the given position.
pub enum Align {
    /// Left end of the text.
    Left,
    /// Middle of the text.
    Middle,
    /// Right end of the text.
    Right,
    /// Middle of a text that reads upwards.
    Upward,
}

/// A page to draw on.
#[derive(Default)]
pub struct Canvas {
    elements: Vec<String>,
}

/// Rounds a length to the grid; a point far outside of the page stays outside.
fn grid(length: f64) -> i32 {
    (length * GRID).clamp(-1e6, 1e6).round() as i32
}

fn list(points: &[Position]) -> String {
    let points: Vec<_> = points.iter().map(|(x, y)| format!("{},{}", grid(*x), grid(*y))).collect();
    points.join(" ")
}

impl Canvas {
    /// Page of the given size as a stand-alone SVG document. `title` is the text that a screen
    /// reader says in place of the picture.
    pub fn page(self, (width, height): Position, title: &str) -> String {
        // 96 pixels are an inch.
        let [wide, high] = [width, height].map(|length| length * 2.54 / 96.0);
        let [width, height] = [width, height].map(grid);
        let (title, elements) = (escape(title), self.elements.join("\n"));
        // With mitred joints a noisy curve would turn into needles.
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" width=\"{wide:.2}cm\" \
             height=\"{high:.2}cm\" viewBox=\"0 0 {width} {height}\" \
             stroke-linejoin=\"round\" stroke-linecap=\"round\">\n<title>{title}</title>\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{elements}\n</svg>\n"
        )
    }

    /// Draws the part of a line that lies in the box between two corners.
    pub fn clipped(&mut self, from: Position, to: Position, points: &[Position], stroke: Stroke) {
        let [x, y, width, height] = [from.0, from.1, to.0 - from.0, to.1 - from.1].map(grid);
        self.elements.push(format!(
            r#"<svg x="{x}" y="{y}" width="{width}" height="{height}" viewBox="{x} {y} {width} {height}">"#
        ));
        self.polyline(points, stroke);
        self.elements.push("</svg>".into());
    }

    /// Draws a line through `points`; one that is not finite interrupts it.
    pub fn polyline(&mut self, points: &[Position], stroke: Stroke) {
        let Stroke { color, width, opacity, dashed } = stroke;
        // Round line ends shorten what is seen of a gap.
        let dashes = if dashed { r#" stroke-dasharray="80 64""# } else { "" };
        let width = grid(width);
        let runs = points.split(|(x, y)| !(x.is_finite() && y.is_finite()));
        self.elements.extend(runs.filter(|run| run.len() > 1).map(|run| {
            format!(
                "<polyline fill=\"none\" opacity=\"{opacity}\" stroke=\"{color}\" \
                 stroke-width=\"{width}\"{dashes} points=\"{}\"/>",
                list(run)
            )
        }));
    }

    /// Draws an area without a border.
    pub fn area(&mut self, corners: &[Position], color: Color, opacity: f64) {
        let (points, opacity) = (list(corners), (100.0 * opacity).round() / 100.0);
        self.elements
            .push(format!(r#"<polygon fill="{color}" opacity="{opacity}" points="{points}"/>"#));
    }

    /// Draws boxes of one size, each given by the middle of its left side, as strokes, which take
    /// half the text of outlines.
    pub fn boxes(&mut self, boxes: &[Position], size: Position, color: Color, opacity: f64) {
        let (width, height) = (grid(size.0), grid(size.1));
        let path: String =
            boxes.iter().map(|(x, y)| format!("M{} {}h{width}", grid(*x), grid(*y))).collect();
        self.elements.push(format!(
            "<path shape-rendering=\"crispEdges\" stroke-linecap=\"butt\" stroke=\"{color}\" \
             stroke-width=\"{height}\" opacity=\"{opacity:.3}\" d=\"{path}\"/>"
        ));
    }

    /// Draws a marker; a hollow one shows the paper inside.
    pub fn marker(&mut self, at: Position, look: Look, radius: f64) {
        let shape = if look.marker.is_empty() {
            let [x, y, r] = [at.0, at.1, radius].map(grid);
            format!(r#"circle cx="{x}" cy="{y}" r="{r}""#)
        } else {
            let corners = look.marker.iter().map(|(x, y)| (at.0 + radius * x, at.1 + radius * y));
            let corners: Vec<_> = corners.collect();
            format!(r#"polygon points="{}""#, list(&corners))
        };
        let color = look.color;
        self.elements.push(match look.hollow() {
            true => format!(r##"<{shape} fill="#FFFFFF" stroke="{color}" stroke-width="22"/>"##),
            false => format!(r#"<{shape} fill="{color}"/>"#),
        });
    }

    /// Draws a label on one line, centred vertically at `at`; one that reads upwards is centred
    /// both ways.
    pub fn label(&mut self, label: &Label, at: Position, size: f64, align: Align) {
        let ([x, y, size], text) = ([at.0, at.1, size].map(grid), markup(label));
        let (anchor, turn) = match align {
            Align::Left => ("start", 0),
            Align::Middle => ("middle", 0),
            Align::Right => ("end", 0),
            Align::Upward => ("middle", 270),
        };
        self.elements.push(format!(
            "<text x=\"{x}\" y=\"{y}\" dy=\"0.5ex\" text-anchor=\"{anchor}\" \
             transform=\"rotate({turn}, {x}, {y})\" font-family=\"sans-serif\" \
             font-size=\"{size}\" fill=\"{INK}\">{text}</text>"
        ));
    }
}

/// Distances of an index below the line and of an exponent above it, in units of the base.
const SINK: f64 = 0.28 * SCRIPT_SIZE;
const RISE: f64 = 0.5 * SCRIPT_SIZE;

/// The content of a `text` element. The browser places indices and exponents by the true width of
/// the base, whatever the font.
pub fn markup(label: &Label) -> String {
    // A shift holds for all that follows: each part is moved from where the one before it stands.
    let (mut markup, mut height) = (escape(&label.base), 0.0);
    let scripts = [(&label.index, -SINK, SCRIPT_SIZE), (&label.exponent, RISE, SCRIPT_SIZE)];
    for (text, level, size) in scripts.into_iter().chain([(&label.tail, 0.0, 1.0)]) {
        if !text.is_empty() {
            let (shift, percent, text) = ((height - level) / size, 100.0 * size, escape(text));
            markup +=
                &format!("<tspan dy=\"{shift:.2}em\" font-size=\"{percent}%\">{text}</tspan>");
            height = level;
        }
    }
    markup
}
