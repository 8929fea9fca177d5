//! The legend: rows above the plot, where no curve can reach it.

use std::io::Result;

use super::canvas::{Align, Canvas};
use super::look::Look;
use super::stroke::Stroke;
use crate::label::Label;

/// Font size in pixels.
const SIZE: f64 = 10.5;
/// Height of a row in pixels.
const ROW: f64 = 14.0;
/// Distance from one entry to the next.
const GAP: f64 = 9.0;

/// What stands in front of a name.
#[derive(Clone, Copy, Debug)]
pub enum Sample {
    /// A line with a marker.
    Curve(Look),
    /// A line without markers.
    Line(Stroke),
    /// A marker without a line.
    Point {
        /// Its appearance.
        look: Look,
        /// Whether the paper shows inside.
        hollow: bool,
    },
}

impl Sample {
    fn width(self) -> f64 {
        match self {
            // Long enough for a dash on both sides of the marker.
            Sample::Curve(_) | Sample::Line(_) => 17.5,
            Sample::Point { .. } => 7.0,
        }
    }
}

/// The entries in rows that are no wider than `width`.
pub struct Legend {
    rows: Vec<Vec<(Sample, Label)>>,
}

impl Legend {
    /// Breaks the entries into rows.
    pub fn new(entries: Vec<(Sample, Label)>, width: f64) -> Self {
        let mut rows: Vec<Vec<_>> = Vec::new();
        let mut taken = f64::INFINITY;
        for (sample, label) in entries {
            let needed = entry_width(sample, &label);
            // The gap behind the last entry of a row may stick out.
            if taken + needed > width + GAP {
                rows.push(Vec::new());
                taken = 0.0;
            }
            taken += needed;
            if let Some(row) = rows.last_mut() {
                row.push((sample, label));
            }
        }
        Self { rows }
    }

    /// Height of all rows.
    pub fn height(&self) -> f64 {
        ROW * self.rows.len() as f64
    }

    /// Draws the rows from `top` down, starting at `left`.
    pub fn draw(&self, canvas: &mut Canvas, left: f64, top: f64) -> Result<()> {
        for (n, row) in self.rows.iter().enumerate() {
            let y = top + ROW * (n as f64 + 0.5);
            let mut x = left;
            for (sample, label) in row {
                let end = x + sample.width();
                let middle = (0.5 * (x + end), y);
                match *sample {
                    Sample::Curve(look) => {
                        canvas.polyline(&[(x, y), (end, y)], look.line(1.2))?;
                        canvas.marker(middle, look, look.radius(2.8), look.hollow())?;
                    }
                    Sample::Line(stroke) => canvas.polyline(&[(x, y), (end, y)], stroke)?,
                    Sample::Point { look, hollow } => canvas.marker(middle, look, 2.8, hollow)?,
                }
                canvas.label(label, (end + 4.0, y), SIZE, Align::Left)?;
                x += entry_width(*sample, label);
            }
        }
        Ok(())
    }
}

fn entry_width(sample: Sample, label: &Label) -> f64 {
    sample.width() + 4.0 + SIZE * label.width() + GAP
}
