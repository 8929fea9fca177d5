//! Lines to compare curves with, and the places where their names fit.

use super::canvas::{Align, Canvas, GREY};
use super::frame::Frame;
use super::stroke::Stroke;
use crate::label::Label;

/// The dashed line `constant · x^power`, with its name beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Its name.
    pub name: String,
    /// Value at x = 1.
    pub constant: f64,
    /// The slope in logarithmic coordinates.
    pub power: f64,
    /// Whether the vertical axis covers it over the range of the data; otherwise it is cut off.
    pub covered: bool,
}

impl Line {
    /// Its value at `x`.
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        self.constant * x.powf(self.power)
    }

    /// Draws the part inside of the frame, and the name on the side of its middle where a line that
    /// rises leaves the data.
    pub(super) fn draw(&self, canvas: &mut Canvas, frame: &Frame) {
        const SIZE: f64 = 10.0;
        const OFFSET: f64 = 3.0;
        let [from, to] = [frame.x.range.lo, frame.x.range.hi].map(|x| frame.place(x, self.at(x)));
        let Some((from, to)) = frame.clip(from, to) else { return };
        canvas.polyline(&[from, to], Stroke::new(GREY, 1.0).dashed());
        let label = Label::words(&self.name);
        let (x, y) = (0.5 * (from.0 + to.0), 0.5 * (from.1 + to.1));
        let (right, down) = (0.5 * SIZE * label.width() + OFFSET, 0.5 * SIZE + OFFSET);
        let at = if 2.0 * y > frame.y.start + frame.y.end {
            (x + right, y + down)
        } else {
            (x - right, y - down)
        };
        canvas.label(&label, at, SIZE, Align::Middle);
    }
}
