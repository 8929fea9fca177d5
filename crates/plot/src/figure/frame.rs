//! The box of a plot with its axes, marks and titles, and a page with one box under a legend.

use super::*;

/// Font size of tick labels in pixels.
const TICK_SIZE: f64 = 10.0;
/// Room to the right of a plot.
pub const RIGHT: f64 = 10.0;
/// Number of small plots in a row; room between them, and above each for its name.
const ACROSS: usize = 3;
const GAP: f64 = 12.0;
const NAME: f64 = 15.0;
/// Room for labels and title below a plot.
pub const BELOW: f64 = 33.0;

/// A box with a horizontal axis, left to right, and a vertical one, bottom to top.
#[derive(Clone, Copy)]
pub struct Frame {
    pub x: Axis,
    pub y: Axis,
}

impl Frame {
    /// Position of a point on the page; it may lie outside of the box.
    pub fn place(&self, x: f64, y: f64) -> Position {
        (self.x.position(x), self.y.position(y))
    }

    /// Positions of points on the page.
    pub fn places(&self, points: impl IntoIterator<Item = (f64, f64)>) -> Vec<Position> {
        points.into_iter().map(|(x, y)| self.place(x, y)).collect()
    }

    /// Whether a position lies in the box, borders included, in spite of rounding.
    pub fn holds(&self, (x, y): Position) -> bool {
        const ROUNDING: f64 = 1e-6;
        (self.x.start - ROUNDING..=self.x.end + ROUNDING).contains(&x)
            && (self.y.end - ROUNDING..=self.y.start + ROUNDING).contains(&y)
    }

    /// Draws the part of a line that lies in the box.
    pub fn polyline(&self, canvas: &mut Canvas, points: &[Position], stroke: Stroke) {
        let (from, to) = ((self.x.start, self.y.end), (self.x.end, self.y.start));
        canvas.clipped(from, to, points, stroke);
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
            let mut mark = |value, length| {
                canvas.polyline(&[place(value, 0.0), place(value, length)], ink);
            };
            ticks.major.iter().for_each(|(value, _)| mark(*value, 3.5));
            ticks.minor.iter().for_each(|value| mark(*value, 2.0));
        }
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)];
        canvas.polyline(&corners, ink);
        let mut label = |label: &Label, at, align| canvas.label(label, at, TICK_SIZE, align);
        for (value, text) in &y.major {
            // Digits are taller than the letters by whose height text is centred.
            let (x, y) = row(*value, -4.0);
            label(text, (x, y + 0.08 * TICK_SIZE), Align::Right);
        }
        y.factor.iter().for_each(|text| label(text, (left - 4.0, top - 11.0), Align::Right));
        let below = bottom + 23.5;
        if let Some(title) = x_title {
            for (value, text) in &x.major {
                label(text, column(*value, -9.5), Align::Middle);
            }
            x.factor.iter().for_each(|text| label(text, (right, below), Align::Right));
            write(canvas, title, (self.middle().0, below), Align::Middle);
        }
        if let Some(title) = y_title {
            write(canvas, title, (7.5, self.middle().1), Align::Upward);
        }
    }

    /// Writes words into the middle of the box.
    pub fn say(&self, canvas: &mut Canvas, words: &str) {
        write(canvas, words, self.middle(), Align::Middle);
    }

    fn middle(&self) -> Position {
        (0.5 * (self.x.start + self.x.end), 0.5 * (self.y.start + self.y.end))
    }
}

fn write(canvas: &mut Canvas, words: &str, at: Position, align: Align) {
    canvas.label(&Label::words(words), at, 10.5, align);
}

/// A page of small plots over the same axes in rows of three as an SVG document, each with its name
/// above it. They leave room on the left and below, and have a height that follows from their
/// width. `draw` gets the box of a plot, its number and those in a row, and its data.
pub fn small<T>(
    title: &str,
    plots: &[(String, T)],
    [x, y]: [Axis; 2],
    (left, below): (f64, f64),
    height: impl Fn(f64) -> f64,
    draw: impl Fn(&mut Canvas, Frame, (usize, usize), &T),
) -> String {
    let columns = ACROSS.min(plots.len()).max(1);
    let width = (WIDTH - left - RIGHT + GAP) / columns as f64 - GAP;
    let pitch = NAME + height(width) + GAP;
    let mut canvas = Canvas::default();
    for (k, (name, data)) in plots.iter().enumerate() {
        let left = left + (width + GAP) * (k % columns) as f64;
        let (right, top) = (left + width, NAME + pitch * (k / columns) as f64);
        let y = y.over(top + height(right - left), top);
        draw(&mut canvas, Frame { x: x.over(left, right), y }, (k, columns), data);
        canvas.label(&Label::words(name), (left + 0.5 * width, top - 7.5), 8.5, Align::Middle);
    }
    let rows = plots.len().div_ceil(columns) as f64;
    canvas.page((WIDTH, pitch * rows - GAP + below), title)
}

/// Width of a page in pixels.
const WIDTH: f64 = 340.0;
/// Room for the labels on the left.
const LEFT: f64 = 52.0;

/// The title of an axis, and whether the axis is logarithmic.
#[derive(Clone, Copy, Debug)]
pub struct Title<'a> {
    /// The words.
    pub words: &'a str,
    /// Whether the axis is logarithmic: equal ratios are equally far apart.
    pub logarithmic: bool,
}

impl<'a> From<&'a str> for Title<'a> {
    fn from(words: &'a str) -> Self {
        Self { words, logarithmic: false }
    }
}

impl Title<'_> {
    /// The axis of values; a linear one is widened by `share` of its length at both ends.
    pub fn axis(&self, values: impl Iterator<Item = f64>, share: f64) -> Axis {
        if self.logarithmic {
            let range = Range::of_positive(values, Range { lo: 0.1, hi: 10.0 }).times(1.1);
            return Axis { logarithmic: true, ..Axis::linear(range) };
        }
        Axis::of(values, share)
    }
}

/// A page with one plot under a legend; another may be set below it.
pub struct Plain {
    pub canvas: Canvas,
    pub frame: Frame,
}

impl Plain {
    /// Draws legend and axes; each axis has a title, except one above another plot.
    pub fn new<'a>(
        entries: impl IntoIterator<Item = (Sample, &'a str)>,
        height: f64,
        (x, x_title): (Axis, Option<&str>),
        (y, y_title): (Axis, &str),
    ) -> Self {
        let mut canvas = Canvas::default();
        let entries = entries.into_iter().map(|(sample, name)| (sample, Label::words(name)));
        let top = legend(&mut canvas, entries, LEFT, WIDTH - LEFT - RIGHT);
        let frame = Frame { x: x.over(LEFT, WIDTH - RIGHT), y: y.over(top + height, top) };
        frame.draw(&mut canvas, (&x.ticks(6), x_title), (&y.ticks(5), Some(y_title)));
        Self { canvas, frame }
    }

    pub fn line(&mut self, points: impl IntoIterator<Item = (f64, f64)>, stroke: Stroke) {
        self.frame.polyline(&mut self.canvas, &self.frame.places(points), stroke);
    }

    /// Page as an SVG document; an empty page says so.
    pub fn page(mut self, title: &str, empty: bool) -> String {
        if empty {
            self.frame.say(&mut self.canvas, "no data");
        }
        self.canvas.page((WIDTH, self.frame.y.start + BELOW), title)
    }
}
