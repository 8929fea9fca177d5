//! Lines to compare curves with, and the places where their names fit.

use super::canvas::{Align, Canvas, GREY};
use super::frame::Frame;
use super::stroke::{Position, Stroke};
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

    /// Draws the line across the frame and its name where it is farthest from `obstacles`. Line and
    /// name become obstacles themselves.
    pub(super) fn draw(&self, canvas: &mut Canvas, frame: &Frame, obstacles: &mut Vec<Position>) {
        const SIZE: f64 = 10.0;
        let ends = [frame.x.range.lo, frame.x.range.hi].map(|x| frame.place(x, self.at(x)));
        let Some((from, to)) = frame.clip(ends[0], ends[1]) else {
            return;
        };
        canvas.polyline(&[from, to], Stroke::new(GREY, 1.0).dashed());
        let label = Label::words(&self.name);
        let size = (SIZE * label.width(), SIZE);
        if let Some(centre) = roomiest(frame, (from, to), size, obstacles) {
            canvas.label(&label, centre, SIZE, Align::Middle);
            let half = size.0 / 2.0;
            obstacles.extend(along((centre.0 - half, centre.1), (centre.0 + half, centre.1)));
        }
        obstacles.extend(along(from, to));
    }
}

/// Points a few pixels apart along a segment.
pub fn along(from: Position, to: Position) -> impl Iterator<Item = Position> {
    const STEP: f64 = 3.0;
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let steps = (dx.hypot(dy) / STEP).ceil().clamp(1.0, 1000.0);
    (0..=steps as usize)
        .map(move |n| (from.0 + dx * n as f64 / steps, from.1 + dy * n as f64 / steps))
}

/// Centre of the text box beside a rising line that keeps the largest distance from the obstacles.
fn roomiest(
    frame: &Frame,
    (from, to): (Position, Position),
    (width, height): (f64, f64),
    obstacles: &[Position],
) -> Option<Position> {
    const OFFSET: f64 = 3.0;
    let half = (0.5 * width, 0.5 * height);
    let sides = [1.0, -1.0];
    let candidates = along(from, to).flat_map(|p| {
        sides.map(|side| (p.0 + side * (half.0 + OFFSET), p.1 + side * (half.1 + OFFSET)))
    });
    let inside = |c: &Position| {
        frame.holds((c.0 - half.0 - OFFSET, c.1 - half.1 - OFFSET))
            && frame.holds((c.0 + half.0 + OFFSET, c.1 + half.1 + OFFSET))
    };
    let room = |c: &Position| {
        obstacles
            .iter()
            .map(|o| {
                let (dx, dy) = ((o.0 - c.0).abs() - half.0, (o.1 - c.1).abs() - half.1);
                dx.max(0.0).hypot(dy.max(0.0))
            })
            .fold(f64::INFINITY, f64::min)
    };
    candidates.filter(inside).max_by(|a, b| room(a).total_cmp(&room(b)))
}
