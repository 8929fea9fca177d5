//! The box of a plot: its axes, marks and titles, and the clipping of what leaves it.

use super::{
    axis::Axis,
    canvas::{Align, Canvas, FAINT, INK},
    stroke::{Position, Stroke},
    ticks::Ticks,
};
use crate::label::Label;

/// Font size of tick labels in pixels.
const TICK_SIZE: f64 = 10.0;
/// Font size of axis titles in pixels.
const TITLE_SIZE: f64 = 10.5;

/// A box with two axes.
#[derive(Clone, Copy)]
pub struct Frame {
    /// Horizontal axis, left to right.
    pub x: Axis,
    /// Vertical axis, bottom to top.
    pub y: Axis,
}

impl Frame {
    /// Position of a point on the page; it may lie outside of the box.
    pub fn place(&self, x: f64, y: f64) -> Position {
        (self.x.position(x), self.y.position(y))
    }

    /// Whether a position lies in the box, borders included.
    pub fn holds(&self, (x, y): Position) -> bool {
        // A point on the border stays inside in spite of the rounding of its position.
        const ROUNDING: f64 = 1e-6;
        (self.x.start - ROUNDING..=self.x.end + ROUNDING).contains(&x)
            && (self.y.end - ROUNDING..=self.y.start + ROUNDING).contains(&y)
    }

    /// The part of a segment that lies in the box (Liang and Barsky); none if an end is not finite.
    pub fn clip(&self, a: Position, b: Position) -> Option<(Position, Position)> {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        if !(dx.is_finite() && dy.is_finite()) {
            return None;
        }
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        let borders = [
            (-dx, a.0 - self.x.start),
            (dx, self.x.end - a.0),
            (-dy, a.1 - self.y.end),
            (dy, self.y.start - a.1),
        ];
        for (speed, distance) in borders {
            match distance / speed {
                s if speed < 0.0 => enter = enter.max(s),
                s if speed > 0.0 => leave = leave.min(s),
                _ if distance < 0.0 => return None,
                _ => {}
            }
        }
        let at = |s: f64| (a.0 + s * dx, a.1 + s * dy);
        (enter <= leave).then(|| (at(enter), at(leave)))
    }

    /// Draws the part of a line that lies in the box; a point that is not finite interrupts it.
    pub fn polyline(&self, canvas: &mut Canvas, points: &[Position], stroke: Stroke) {
        let mut run: Vec<Position> = Vec::new();
        for (a, b) in points.windows(2).filter_map(|pair| self.clip(pair[0], pair[1])) {
            if run.last() != Some(&a) {
                canvas.polyline(&run, stroke);
                run = vec![a];
            }
            run.push(b);
        }
        canvas.polyline(&run, stroke)
    }

    /// Draws grid, marks, border and labels, the title of the horizontal axis below the labels and
    /// that of the vertical axis at the left edge of the page. A plot that stands on another one
    /// goes without labels and title below.
    pub fn draw(
        &self,
        canvas: &mut Canvas,
        (x, x_title): (&Ticks, Option<&str>),
        (y, y_title): (&Ticks, Option<&str>),
    ) {
        const MAJOR: f64 = 3.5;
        const MINOR: f64 = 2.0;
        // Digits are taller than the letters by whose height text is centred.
        const DIGIT_SHIFT: f64 = 0.08 * TICK_SIZE;
        let (left, right) = (self.x.start, self.x.end);
        let (bottom, top) = (self.y.start, self.y.end);
        let (grid, ink) = (Stroke::new(FAINT, 0.6), Stroke::new(INK, 0.8));
        // Positions by a value on an axis and the distance from the axis into the box.
        let column: &dyn Fn(f64, f64) -> Position =
            &|value, distance| (self.x.position(value), bottom - distance);
        let row = &|value, distance| (left + distance, self.y.position(value));
        let sides = [(x, column, bottom - top), (y, row, right - left)];
        for (ticks, place, across) in sides {
            for (value, _) in &ticks.major {
                canvas.polyline(&[place(*value, across), place(*value, 0.0)], grid);
            }
        }
        for (ticks, place, _) in sides {
            let major = ticks.major.iter().map(|(value, _)| (*value, MAJOR));
            for (value, length) in major.chain(ticks.minor.iter().map(|value| (*value, MINOR))) {
                canvas.polyline(&[place(value, 0.0), place(value, length)], ink);
            }
        }
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)];
        canvas.polyline(&corners, ink);
        let mut label = |label: &Label, at, align| canvas.label(label, at, TICK_SIZE, align);
        for (value, text) in &y.major {
            let (x, y) = row(*value, -4.0);
            label(text, (x, y + DIGIT_SHIFT), Align::Right);
        }
        if let Some(factor) = &y.factor {
            label(factor, (left - 4.0, top - 11.0), Align::Right);
        }
        if let Some(title) = x_title {
            for (value, text) in &x.major {
                label(text, column(*value, -9.5), Align::Middle);
            }
            if let Some(factor) = &x.factor {
                label(factor, (right, bottom + 23.5), Align::Right);
            }
            write(canvas, title, (middle(self.x), bottom + 23.5), Align::Middle);
        }
        if let Some(title) = y_title {
            write(canvas, title, (7.5, middle(self.y)), Align::Upward);
        }
    }

    /// Writes words into the middle of the box.
    pub fn say(&self, canvas: &mut Canvas, words: &str) {
        write(canvas, words, (middle(self.x), middle(self.y)), Align::Middle);
    }
}

fn write(canvas: &mut Canvas, words: &str, at: Position, align: Align) {
    canvas.label(&Label::words(words), at, TITLE_SIZE, align);
}

fn middle(axis: Axis) -> f64 {
    0.5 * (axis.start + axis.end)
}
