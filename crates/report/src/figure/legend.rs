//! The legend: rows above the plot, where no curve can reach it.

use super::{
    canvas::{Align, Canvas},
    look::Look,
    stroke::{Position, Stroke},
};
use crate::label::Label;

/// Font size in pixels.
const SIZE: f64 = 10.5;
/// Height of a row in pixels.
const ROW: f64 = 14.0;
/// Distance from one entry to the next.
const GAP: f64 = 9.0;

/// What stands in front of a name.
#[derive(Clone, Copy)]
pub enum Sample {
    /// A line with a marker.
    Curve(Look),
    /// A line without markers.
    Line(Stroke),
    /// A marker without a line.
    Point(Look),
}

impl Sample {
    fn width(self) -> f64 {
        match self {
            // Long enough for a dash on both sides of the marker.
            Sample::Curve(_) | Sample::Line(_) => 17.5,
            Sample::Point(_) => 7.0,
        }
    }
}

/// The entries in rows that are no wider than a given width.
pub struct Legend {
    entries: Vec<(Position, Sample, Label)>,
    /// Height of all rows.
    pub height: f64,
}

impl Legend {
    /// Breaks the entries into rows.
    pub fn new(entries: impl IntoIterator<Item = (Sample, Label)>, width: f64) -> Self {
        let (mut x, mut height) = (f64::INFINITY, 0.0);
        let mut place = |(sample, label): (Sample, Label)| {
            let needed = sample.width() + 4.0 + SIZE * label.width() + GAP;
            // The gap behind the last entry of a row may stick out.
            if x + needed > width + GAP {
                (x, height) = (0.0, height + ROW);
            }
            x += needed;
            ((x - needed, height - 0.5 * ROW), sample, label)
        };
        let entries = entries.into_iter().map(&mut place).collect();
        Self { entries, height }
    }

    /// Draws the rows from `top` down, starting at `left`.
    pub fn draw(&self, canvas: &mut Canvas, left: f64, top: f64) {
        for (at, sample, label) in &self.entries {
            let (x, y) = (left + at.0, top + at.1);
            let end = x + sample.width();
            let middle = (0.5 * (x + end), y);
            match *sample {
                Sample::Curve(look) => {
                    canvas.polyline(&[(x, y), (end, y)], look.line(1.2));
                    canvas.marker(middle, look, look.radius(2.8), look.hollow());
                }
                Sample::Line(stroke) => canvas.polyline(&[(x, y), (end, y)], stroke),
                Sample::Point(look) => canvas.marker(middle, look, 2.8, look.hollow()),
            }
            canvas.label(label, (end + 4.0, y), SIZE, Align::Left);
        }
    }
}
