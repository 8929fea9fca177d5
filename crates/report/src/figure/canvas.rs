//! Lines, markers and text on an SVG page, measured in CSS pixels at column width.
//!
//! plotters draws on integer coordinates. The canvas therefore draws on a grid [`GRID`] times finer
//! than a pixel and lets the view box scale it back.

use std::io::{Error, Result};

use plotters::backend::DrawingBackend;
use plotters::prelude::{
    Color, FontTransform, IntoFont, RGBColor, SVGBackend, ShapeStyle, TextStyle,
};
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::look::{Look, Marker};
use super::scripts;
use super::stroke::{Position, Stroke, dashes};
use crate::escape::escape;
use crate::label::Label;

/// Ink of axes and text.
pub const INK: RGBColor = RGBColor(34, 34, 34);
/// Ink of grid lines.
pub const FAINT: RGBColor = RGBColor(226, 226, 226);
/// Ink of reference slopes.
pub const GREY: RGBColor = RGBColor(105, 105, 105);
/// The paper.
const WHITE: RGBColor = RGBColor(255, 255, 255);

const GRID: f64 = 20.0;

/// Pixels to a centimetre, by the definition of the CSS pixel.
const PER_CENTIMETRE: f64 = 96.0 / 2.54;

/// Which point of a text lies at the position given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// Its left end.
    Left,
    /// Its middle.
    Middle,
    /// Its right end.
    Right,
}

/// A page to draw on.
pub struct Canvas<'a> {
    backend: SVGBackend<'a>,
}

/// Draws a page of the given size with `draw` and returns it as a stand-alone SVG document.
///
/// `title` is what a screen reader says in place of the picture.
pub fn page(
    (width, height): (f64, f64),
    title: &str,
    draw: impl FnOnce(&mut Canvas) -> Result<()>,
) -> Result<String> {
    let mut svg = String::new();
    let size = ((width * GRID) as u32, (height * GRID) as u32);
    let mut canvas = Canvas { backend: SVGBackend::with_string(&mut svg, size) };
    draw(&mut canvas)?;
    canvas.backend.present().map_err(Error::other)?;
    drop(canvas);
    // The backend writes the grid size as the size of the picture and leaves joints mitred, which
    // turns a noisy curve into needles.
    let body = svg.split_once('>').map_or("", |(_, body)| body);
    let body = scripts::typeset(body);
    Ok(format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" width=\"{:.2}cm\" height=\"{:.2}cm\" \
         viewBox=\"0 0 {} {}\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n<title>{}</title>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>{body}",
        width / PER_CENTIMETRE,
        height / PER_CENTIMETRE,
        size.0,
        size.1,
        escape(title),
    ))
}

fn style(stroke: Stroke) -> ShapeStyle {
    stroke.color.mix(stroke.opacity).stroke_width((stroke.width * GRID).round() as u32)
}

fn grid((x, y): Position) -> (i32, i32) {
    ((x * GRID).round() as i32, (y * GRID).round() as i32)
}

impl Canvas<'_> {
    /// A line through `points`.
    pub fn polyline(&mut self, points: &[Position], stroke: Stroke) -> Result<()> {
        if points.len() < 2 {
            return Ok(());
        }
        let pieces = if stroke.dashed { dashes(points) } else { vec![points.to_vec()] };
        for piece in pieces {
            self.backend
                .draw_path(piece.into_iter().map(grid), &style(stroke))
                .map_err(Error::other)?;
        }
        Ok(())
    }

    /// The outline of a rectangle with opposite corners `a` and `b`.
    pub fn rectangle(&mut self, a: Position, b: Position, stroke: Stroke) -> Result<()> {
        self.polyline(&[a, (b.0, a.1), b, (a.0, b.1), a], stroke)
    }

    /// A marker; a hollow one shows the paper inside.
    pub fn marker(&mut self, at: Position, look: Look, radius: f64, hollow: bool) -> Result<()> {
        let edge = Stroke::new(look.color, 1.1);
        let fill = if hollow { WHITE } else { look.color }.filled();
        let mut corners = outline(look.marker)
            .iter()
            .map(|(x, y)| (at.0 + radius * x, at.1 + radius * y))
            .collect::<Vec<Position>>();
        if corners.is_empty() {
            let size = (radius * GRID) as u32;
            self.backend.draw_circle(grid(at), size, &fill, true).map_err(Error::other)?;
            if hollow {
                let edge = style(edge);
                self.backend.draw_circle(grid(at), size, &edge, false).map_err(Error::other)?;
            }
            return Ok(());
        }
        let filled = corners.iter().copied().map(grid);
        self.backend.fill_polygon(filled, &fill).map_err(Error::other)?;
        if hollow {
            corners.extend_from_within(..2);
            self.polyline(&corners, edge)?;
        }
        Ok(())
    }

    /// A label on one line, centred vertically at `at`.
    pub fn label(&mut self, label: &Label, at: Position, size: f64, align: Align) -> Result<()> {
        let text = scripts::marked(label);
        self.text(&text, at, size, align, FontTransform::None)
    }

    /// Text that reads upwards, centred at `at`.
    pub fn upward_text(&mut self, text: &str, at: Position, size: f64) -> Result<()> {
        self.text(text, at, size, Align::Middle, FontTransform::Rotate270)
    }

    fn text(
        &mut self,
        text: &str,
        at: Position,
        size: f64,
        align: Align,
        transform: FontTransform,
    ) -> Result<()> {
        // The backend divides font sizes by this factor.
        const BACKEND_FACTOR: f64 = 1.24;
        let anchor = match align {
            Align::Left => HPos::Left,
            Align::Middle => HPos::Center,
            Align::Right => HPos::Right,
        };
        let font = ("sans-serif", (size * GRID).round() * BACKEND_FACTOR).into_font();
        let style = TextStyle::from(font.transform(transform))
            .color(&INK)
            .pos(Pos::new(anchor, VPos::Center));
        self.backend.draw_text(text, &style, grid(at)).map_err(Error::other)
    }
}

/// Corners of a marker of radius one, none of a circle. The areas are about that of the circle, so that no curve
/// looks more important than another.
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
