//! Curves in logarithmic coordinates: plots side by side under one legend and with one vertical
//! axis.

use std::collections::HashMap;

use super::{
    axis::{Axis, Range, Scale},
    canvas::{Align, Canvas, GREY, INK},
    frame::Frame,
    legend::{Sample, legend},
    look::{self, CIRCLE, Layer, Look},
    stroke::Stroke,
    ticks::{Spacing, Ticks},
};
use crate::{
    label::Label,
    series::{QUANTILE, distinct},
};

/// A measured point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Step size, cost or number of steps; a point that is not positive is not drawn.
    pub x: f64,
    /// Upper end of the spread of `x`; equal to `x` where it has none.
    pub x_hi: f64,
    /// The value, whose size is drawn; a point that is not finite is left out.
    pub y: f64,
    /// The 95 % interval of `y`; none where `y` has no statistical error.
    pub interval: Option<(f64, f64)>,
}

/// A curve.
#[derive(Clone, Debug)]
pub struct Curve {
    /// The scheme or the quantity: curves of one name look the same in all plots of a figure.
    pub name: String,
    /// What the legend adds to the name, for example a fitted order.
    pub note: String,
    /// The points.
    pub points: Vec<Measured>,
}

/// What the names of curves are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// Schemes, in plain words; known schemes have fixed colours.
    Schemes,
    /// Quantities in the notation of [`Label`] whose sign matters: markers are hollow where values
    /// are negative, and curves are set side by side, since their intervals are long.
    Signed,
}

/// The line `constant · x^power`, dashed and grey, with its name beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Its name in the legend.
    pub name: String,
    /// Value at x = 1.
    pub constant: f64,
    /// The slope in logarithmic coordinates.
    pub power: f64,
}

/// One plot of a figure.
#[derive(Clone, Debug)]
pub struct Plot {
    /// Title of its horizontal axis.
    pub x_title: String,
    /// The marks of its horizontal axis.
    pub spacing: Spacing,
    /// Lines to compare the curves with.
    pub lines: Vec<Line>,
    /// Its curves.
    pub curves: Vec<Curve>,
}

/// Plots side by side with one vertical axis and one legend; both axes are logarithmic.
#[derive(Clone, Debug)]
pub struct Figure {
    /// What a screen reader says in place of the picture.
    pub title: String,
    /// Title of the vertical axis.
    pub y_title: String,
    /// Width and height of a plot in CSS pixels.
    pub size: (f64, f64),
    /// How curves are named and coloured.
    pub style: Style,
    /// The plots from left to right.
    pub plots: Vec<Plot>,
}

/// Width and height of a plot that fills a journal column, in CSS pixels.
pub const COLUMN: (f64, f64) = (284.0, 214.0);
/// Room for the labels on the left.
const LEFT: f64 = 46.0;
const BETWEEN: f64 = 44.0;
/// Room to the right of a plot.
pub const RIGHT: f64 = 10.0;
/// Room for labels and title below a plot.
pub const BELOW: f64 = 33.0;
const MARKER_RADIUS: f64 = 3.0;

impl Measured {
    /// A point without intervals.
    pub fn new(x: f64, y: f64) -> Self {
        Self { x, x_hi: x, y, interval: None }
    }

    /// Ends of the interval of the size.
    fn ends(&self) -> (f64, f64) {
        let (lo, hi) = self.interval.unwrap_or((self.y, self.y));
        if self.y < 0.0 { (-hi, -lo) } else { (lo, hi) }
    }
}

impl Line {
    /// Its value at `x`.
    pub fn at(&self, x: f64) -> f64 {
        self.constant * x.powf(self.power)
    }

    /// Draws the part inside of the frame, and the name beside its middle: on the side where a line
    /// that rises leaves the data.
    fn draw(&self, canvas: &mut Canvas, frame: &Frame) {
        const SIZE: f64 = 10.0;
        const OFFSET: f64 = 3.0;
        let [from, to] = [frame.x.range.lo, frame.x.range.hi].map(|x| frame.place(x, self.at(x)));
        let Some((from, to)) = frame.clip(from, to) else { return };
        canvas.polyline(&[from, to], Stroke::new(GREY, 1.0).dashed());
        let label = Label::words(&self.name);
        let (x, y) = (0.5 * (from.0 + to.0), 0.5 * (from.1 + to.1));
        let (right, down) = (0.5 * SIZE * label.width() + OFFSET, 0.5 * SIZE + OFFSET);
        let below = 2.0 * y > frame.y.start + frame.y.end;
        let at = if below { (x + right, y + down) } else { (x - right, y - down) };
        canvas.label(&label, at, SIZE, Align::Middle);
    }
}

impl Curve {
    /// A curve with nothing but its name in the legend.
    pub fn new(name: &str, points: impl IntoIterator<Item = Measured>) -> Self {
        Self { name: name.into(), note: String::new(), points: points.into_iter().collect() }
    }

    pub(super) fn drawn(&self) -> impl Iterator<Item = &Measured> {
        self.points.iter().filter(|p| p.x > 0.0 && p.x.is_finite() && p.y.is_finite())
    }

    /// Pairs (x, size) of the points that stand out from their noise, or of all if none does.
    pub(super) fn trend(&self) -> Vec<(f64, f64)> {
        let clear = |point: &Measured| point.ends().0 > 0.0;
        let all = !self.drawn().any(clear);
        let shown =
            self.drawn().filter(|point| if all { point.y.abs() > 0.0 } else { clear(point) });
        shown.map(|point| (point.x, point.y.abs())).collect()
    }
}

impl Figure {
    /// The figure as an SVG document.
    pub fn svg(&self) -> String {
        let curves = || self.plots.iter().flat_map(|plot| &plot.curves);
        let names = distinct(curves().map(|curve| curve.name.as_str()));
        let signed = self.style == Style::Signed;
        let looks = if signed { look::of_quantities(&names) } else { look::of_schemes(&names) };
        let looks: HashMap<&str, Look> = names.iter().copied().zip(looks).collect();
        let entry = |name: &&str| {
            let label = if signed { Label::new(name) } else { Label::words(name) };
            let note = curves().find(|curve| curve.name == *name).map_or("", |curve| &curve.note);
            let tail = if note.is_empty() { String::new() } else { format!(": {note}") };
            (Sample::Curve(looks[name]), Label { tail, ..label })
        };
        let signs = [(Layer::Plain, "> 0"), (Layer::Under, "< 0")].map(|(layer, words)| {
            let look = Look { color: INK, marker: CIRCLE, layer };
            (Sample::Point(look), Label::words(words))
        });
        let signs = signs.into_iter().filter(|_| signed);
        let entries = names.iter().map(entry).chain(signs);
        let width = self.plots.len().max(1) as f64 * (self.size.0 + BETWEEN) - BETWEEN;
        let mut canvas = Canvas::default();
        let top = legend(&mut canvas, entries, LEFT, width);
        let bottom = top + self.size.1;
        let y = self.y_range();
        for (n, plot) in self.plots.iter().enumerate() {
            let start = LEFT + n as f64 * (self.size.0 + BETWEEN);
            let (scale, x) = (Scale::Logarithmic, plot.x_range());
            let frame = Frame {
                x: Axis { scale, range: x, start, end: start + self.size.0 },
                y: Axis { scale, range: y, start: bottom, end: top },
            };
            let x = match plot.spacing {
                Spacing::Decades => Ticks::decades(x, 7),
                Spacing::Doublings => Ticks::powers(2, x, 8),
            };
            let y_title = (n == 0).then_some(&*self.y_title);
            frame.draw(&mut canvas, (&x, Some(&plot.x_title)), (&Ticks::decades(y, 7), y_title));
            plot.draw(&mut canvas, &frame, &looks, signed);
        }
        canvas.page((LEFT + width + RIGHT, bottom + BELOW), &self.title)
    }

    /// Covers the values, their intervals as far as they stay near the value, and the lines.
    fn y_range(&self) -> Range {
        // A value far below its noise, or an interval that comes close to zero, says nothing at a
        // depth that would squeeze the rest of the figure.
        const DEPTH: f64 = 0.25;
        let values = self.plots.iter().flat_map(Plot::drawn).flat_map(|point| {
            let (size, (lo, hi)) = (point.y.abs(), point.ends());
            let noise = (hi - lo) / (2.0 * QUANTILE);
            [size.max(DEPTH * noise), hi, lo.max(DEPTH * size.max(noise))]
        });
        let lines = self.plots.iter().flat_map(|plot| {
            let x = plot.measured(Range { lo: 1.0, hi: 1.0 });
            plot.lines.iter().flat_map(move |line| [line.at(x.lo), line.at(x.hi)])
        });
        Range::of_positive(values.chain(lines), Range { lo: 1e-4, hi: 1.0 })
            .times(1.4)
            .with_two_decades()
    }
}

impl Plot {
    fn drawn(&self) -> impl Iterator<Item = &Measured> {
        self.curves.iter().flat_map(Curve::drawn)
    }

    fn measured(&self, otherwise: Range) -> Range {
        Range::of_positive(self.drawn().map(|point| point.x), otherwise)
    }

    fn x_range(&self) -> Range {
        let range = self.measured(Range { lo: 2f64.powi(-12), hi: 2f64.powi(-5) });
        // A difference of logarithms, because the ratio may overflow.
        let length = range.hi.ln() - range.lo.ln();
        range.times(if length > 0.0 { (0.04 * length).exp() } else { 2.0 })
    }

    fn draw(&self, canvas: &mut Canvas, frame: &Frame, looks: &HashMap<&str, Look>, signed: bool) {
        for line in &self.lines {
            line.draw(canvas, frame);
        }
        let middle = 0.5 * (self.curves.len() as f64 - 1.0);
        let look = |curve: &Curve| looks[&*curve.name];
        let mut from_below: Vec<_> = self.curves.iter().enumerate().collect();
        from_below.sort_by_key(|(_, curve)| look(curve).layer);
        for (n, curve) in from_below {
            let look = look(curve);
            let shift = if signed { 2.4 * (n as f64 - middle) } else { 0.0 };
            // A point below the range shows its whole marker at the floor.
            let radius = look.radius(MARKER_RADIUS);
            let place = |x: f64, point: &Measured| {
                let (x, y) = frame.place(x, point.y.abs());
                (x + shift, y.clamp(frame.y.end, frame.y.start - radius))
            };
            let places: Vec<_> = curve.drawn().map(|point| place(point.x, point)).collect();
            let line = look.line(if signed { 0.8 } else { 1.2 });
            frame.polyline(canvas, &places, if signed { line.faded(0.45) } else { line });
            let bar = Stroke::new(look.color, 1.0);
            for (point, at) in curve.drawn().zip(places) {
                if point.interval.is_some() {
                    error_bar(canvas, frame, point.ends(), at.0, bar);
                }
                if point.x_hi > point.x {
                    frame.polyline(canvas, &[at, place(point.x_hi, point)], bar);
                }
                canvas.marker(at, look, radius, look.hollow() || signed && point.y < 0.0);
            }
        }
        if self.drawn().next().is_none() {
            frame.say(canvas, "no data");
        }
    }
}

/// Draws an interval; where it reaches zero or leaves the frame it ends at the border, uncapped.
fn error_bar(canvas: &mut Canvas, frame: &Frame, (lo, hi): (f64, f64), x: f64, stroke: Stroke) {
    const CAP: f64 = 2.2;
    let [low, high] = [lo, hi].map(|value| frame.y.position(value));
    frame.polyline(canvas, &[(x, low), (x, high)], stroke);
    for (y, value) in [(low, lo), (high, hi)] {
        if (frame.y.range.lo..=frame.y.range.hi).contains(&value) {
            canvas.polyline(&[(x - CAP, y), (x + CAP, y)], stroke);
        }
    }
}
