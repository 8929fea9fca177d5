//! One plot with linear axes under a legend.

use super::{
    axis::{Axis, Range, Scale},
    canvas::Canvas,
    chart::{BELOW, RIGHT},
    frame::Frame,
    legend::{Sample, legend},
    stroke::{Position, Stroke},
    ticks::Ticks,
};
use crate::label::Label;

const WIDTH: f64 = 340.0;
/// Room for the labels on the left.
const LEFT: f64 = 52.0;
/// The range of an axis without data.
pub const UNIT: Range = Range { lo: 0.0, hi: 1.0 };

/// A page with one plot, on which curves may be drawn; another may be set below it.
pub struct Plain {
    pub canvas: Canvas,
    pub frame: Frame,
}

impl Plain {
    /// Draws legend and axes; each axis has a range and a title, but for one above another plot.
    pub fn new(
        entries: impl Iterator<Item = (Sample, Label)>,
        height: f64,
        (x, x_title): (Range, Option<&str>),
        (y, y_title): (Range, &str),
    ) -> Self {
        let mut canvas = Canvas::default();
        let top = legend(&mut canvas, entries, LEFT, WIDTH - LEFT - RIGHT);
        let axis = |range, start, end| Axis { scale: Scale::Linear, range, start, end };
        let frame = Frame { x: axis(x, LEFT, WIDTH - RIGHT), y: axis(y, top + height, top) };
        let x = (&Ticks::decimal(x, 6), x_title);
        frame.draw(&mut canvas, x, (&Ticks::decimal(y, 5), Some(y_title)));
        Self { canvas, frame }
    }

    pub fn places(&self, points: impl IntoIterator<Item = (f64, f64)>) -> Vec<Position> {
        points.into_iter().map(|(x, y)| self.frame.place(x, y)).collect()
    }

    pub fn line(&mut self, points: impl IntoIterator<Item = (f64, f64)>, stroke: Stroke) {
        let places = self.places(points);
        self.frame.polyline(&mut self.canvas, &places, stroke);
    }

    /// The page as an SVG document, which says so where it is empty.
    pub fn page(mut self, title: &str, empty: bool) -> String {
        if empty {
            self.frame.say(&mut self.canvas, "no data");
        }
        self.canvas.page((WIDTH, self.frame.y.start + BELOW), title)
    }
}
