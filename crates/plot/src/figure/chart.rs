//! Curves in logarithmic coordinates: plots side by side under one legend and with one vertical
//! axis.

use real::elementary::{exp, ln, powf};
use std::collections::{HashMap, HashSet};

use super::*;
use crate::series::QUANTILE;

/// A measured point with its 95 % interval, which may be empty.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    /// Step size, cost or number of steps.
    pub x: f64,
    /// Value, whose size is drawn.
    pub y: f64,
    /// Lower end of the interval.
    pub lo: f64,
    /// Upper end of the interval.
    pub hi: f64,
}

/// A curve with its name, a note for the legend and its points.
pub struct Curve {
    /// Name of the scheme or quantity: curves of one name look the same in all plots of a figure.
    pub name: String,
    /// Note that the legend adds to the name, for example a fitted order.
    pub note: String,
    /// The points that can be drawn.
    pub points: Vec<Measured>,
}

/// The line `constant · x^power`, dashed and grey, with its name beside it.
#[derive(Clone, Copy)]
pub struct Line {
    pub name: &'static str,
    pub constant: f64,
    /// The slope in logarithmic coordinates, which is positive.
    pub power: f64,
}

/// One plot among those of a figure, with logarithmic axes.
pub struct Plot {
    /// Title of the horizontal axis.
    pub x_title: String,
    /// Whether the horizontal axis is marked at powers of ten, and not of two.
    pub decades: bool,
    /// Curves of the plot.
    pub curves: Vec<Curve>,
}

/// Plots side by side with one vertical axis and one legend; both axes are logarithmic.
pub struct Figure {
    /// Text that a screen reader says in place of the picture.
    pub title: String,
    /// Title of the vertical axis.
    pub y_title: String,
    /// Whether curves are quantities in the notation of [`Label`] whose sign matters: markers are
    /// hollow where values are negative, and curves are set side by side, since their intervals are
    /// long. Otherwise they are schemes, in plain words.
    pub signed: bool,
    /// Lines to compare the curves with.
    pub lines: Vec<Line>,
    /// The plots from left to right.
    pub plots: Vec<Plot>,
}

/// Width and height of a plot that fills a journal column, in CSS pixels.
const WIDTH: f64 = 284.0;
const HEIGHT: f64 = 214.0;
/// Room for the labels on the left.
const LEFT: f64 = 46.0;
const BETWEEN: f64 = 44.0;

impl Measured {
    /// Ends of the interval of the absolute value.
    fn ends(&self) -> (f64, f64) {
        if self.y < 0.0 { (-self.hi, -self.lo) } else { (self.lo, self.hi) }
    }
}

impl Curve {
    /// Creates a curve from the points that can be drawn: x positive, x and y finite.
    pub fn new(name: &str, points: impl IntoIterator<Item = Measured>) -> Self {
        let points = points.into_iter().filter(|p| p.x > 0.0 && p.x.is_finite() && p.y.is_finite());
        Self { name: name.into(), note: String::new(), points: points.collect() }
    }

    /// Pairs (x, size) of the points that stand out from their noise, or of all if none does.
    pub fn trend(&self) -> Vec<(f64, f64)> {
        let clear = |point: &Measured| point.ends().0 > 0.0;
        let any = self.points.iter().any(clear);
        let shown = self.points.iter().filter(|p| if any { clear(p) } else { p.y.abs() > 0.0 });
        shown.map(|point| (point.x, point.y.abs())).collect()
    }
}

impl Line {
    pub fn at(&self, x: f64) -> f64 {
        self.constant * powf(x, self.power)
    }

    /// Draws the part inside of the frame, and the name beside its middle: on the side where a line
    /// that rises leaves the data.
    fn draw(&self, canvas: &mut Canvas, frame: &Frame) {
        const SIZE: f64 = 10.0;
        let inverse = |y: f64| powf(y / self.constant, 1.0 / self.power);
        let [x, y] = [frame.x.range, frame.y.range];
        let (lo, hi) = (x.lo.max(inverse(y.lo)), x.hi.min(inverse(y.hi)));
        if lo < hi {
            let [from, to] = [lo, hi].map(|x| frame.place(x, self.at(x)));
            canvas.polyline(&[from, to], Stroke::new(GREY, 1.0).dashed());
            let label = Label::words(self.name);
            let (x, y) = (0.5 * (from.0 + to.0), 0.5 * (from.1 + to.1));
            let (right, down) = (0.5 * SIZE * label.width() + 3.0, 0.5 * SIZE + 3.0);
            let side = if 2.0 * y > frame.y.start + frame.y.end { 1.0 } else { -1.0 };
            canvas.label(&label, (x + side * right, y + side * down), SIZE, Align::Middle);
        }
    }
}

/// Plots of curves of schemes side by side as an SVG document, with one vertical axis; all axes are
/// logarithmic.
pub fn side_by_side(title: &str, y_title: &str, plots: Vec<Plot>) -> String {
    let (title, y_title) = (title.into(), y_title.into());
    Figure { title, y_title, signed: false, lines: Vec::new(), plots }.svg()
}

impl Figure {
    /// The figure as an SVG document.
    pub fn svg(&self) -> String {
        let curves = || self.plots.iter().flat_map(|plot| &plot.curves);
        let mut names: Vec<&str> = curves().map(|curve| &*curve.name).collect();
        let mut seen = HashSet::new();
        names.retain(|name| seen.insert(*name));
        let signed = self.signed;
        let looks = if signed { of_quantities(names.len()) } else { of_schemes(&names) };
        let looks: HashMap<&str, Look> = names.iter().copied().zip(looks).collect();
        let entries = names.iter().map(|name| {
            let label = if signed { Label::new(name) } else { Label::words(name) };
            let note = curves().find(|curve| curve.name == *name).map_or("", |curve| &curve.note);
            let tail = if note.is_empty() { String::new() } else { format!(": {note}") };
            (Sample::Curve(looks[name]), Label { tail, ..label })
        });
        let signs = [(Layer::Plain, "> 0"), (Layer::Under, "< 0")].map(|(layer, words)| {
            (Sample::Point(Look { color: INK, marker: CIRCLE, layer }), Label::words(words))
        });
        let entries = entries.chain(signs.into_iter().filter(|_| signed));
        let width = self.plots.len().max(1) as f64 * (WIDTH + BETWEEN) - BETWEEN;
        let mut canvas = Canvas::default();
        let top = legend(&mut canvas, entries, LEFT, width);
        let axis = |range, start, end| Axis { logarithmic: true, range, start, end };
        let y = axis(self.y_range(), top + HEIGHT, top);
        for (n, plot) in self.plots.iter().enumerate() {
            let start = LEFT + n as f64 * (WIDTH + BETWEEN);
            let range = plot.measured(Range { lo: 2f64.powi(-12), hi: 2f64.powi(-5) });
            // A difference of logarithms, because the ratio may overflow.
            let length = ln(range.hi) - ln(range.lo);
            let range = range.times(if length > 0.0 { exp(0.04 * length) } else { 2.0 });
            let frame = Frame { x: axis(range, start, start + WIDTH), y };
            let x =
                if plot.decades { Ticks::decades(range, 7) } else { Ticks::powers(2, range, 8) };
            let y = (&Ticks::decades(y.range, 7), (n == 0).then_some(&*self.y_title));
            frame.draw(&mut canvas, (&x, Some(&plot.x_title)), y);
            self.lines.iter().for_each(|line| line.draw(&mut canvas, &frame));
            plot.draw(&mut canvas, &frame, &looks, signed);
        }
        canvas.page((LEFT + width + RIGHT, top + HEIGHT + BELOW), &self.title)
    }

    /// Range of the vertical axis: covers the values, their intervals as far as they stay near the
    /// value, and the lines.
    fn y_range(&self) -> Range {
        // A value far below its noise, or an interval that comes close to zero, says nothing at a
        // depth that would squeeze the rest of the figure.
        const DEPTH: f64 = 0.25;
        let values = self.plots.iter().flat_map(Plot::points).flat_map(|point| {
            let (size, (lo, hi)) = (point.y.abs(), point.ends());
            let noise = (hi - lo) / (2.0 * QUANTILE);
            [size.max(DEPTH * noise), hi, lo.max(DEPTH * size.max(noise))]
        });
        let lines = self.plots.iter().flat_map(|plot| {
            let x = plot.measured(Range { lo: 1.0, hi: 1.0 });
            self.lines.iter().flat_map(move |line| [line.at(x.lo), line.at(x.hi)])
        });
        Range::of_positive(values.chain(lines), Range { lo: 1e-4, hi: 1.0 })
            .times(1.4)
            .with_two_decades()
    }
}

impl Plot {
    fn points(&self) -> impl Iterator<Item = &Measured> {
        self.curves.iter().flat_map(|curve| &curve.points)
    }

    fn measured(&self, otherwise: Range) -> Range {
        Range::of_positive(self.points().map(|point| point.x), otherwise)
    }

    fn draw(&self, canvas: &mut Canvas, frame: &Frame, looks: &HashMap<&str, Look>, signed: bool) {
        const CAP: f64 = 2.2;
        let middle = 0.5 * (self.curves.len() as f64 - 1.0);
        let mut from_below: Vec<_> = self.curves.iter().enumerate().collect();
        from_below.sort_by_key(|(_, curve)| looks[&*curve.name].layer);
        for (n, curve) in from_below {
            let look = looks[&*curve.name];
            let shift = if signed { 2.4 * (n as f64 - middle) } else { 0.0 };
            // A point below the range shows its whole marker at the floor.
            let radius = look.radius(3.0);
            let place = |point: &Measured| {
                let (x, y) = frame.place(point.x, point.y.abs());
                (x + shift, y.clamp(frame.y.end, frame.y.start - radius))
            };
            let places: Vec<_> = curve.points.iter().map(place).collect();
            let (width, opacity) = if signed { (0.8, 0.45) } else { (1.2, 1.0) };
            let mut line = look.line(width);
            line.opacity *= opacity;
            frame.polyline(canvas, &places, line);
            let bar = Stroke::new(look.color, 1.0);
            for (point, at) in curve.points.iter().zip(places) {
                // Where an interval reaches zero or leaves the frame it ends at the border,
                // uncapped.
                let (lo, hi) = point.ends();
                if lo < hi {
                    let [low, high] = [lo, hi].map(|value| (at.0, frame.y.position(value)));
                    frame.polyline(canvas, &[low, high], bar);
                    for ((x, y), value) in [(low, lo), (high, hi)] {
                        if (frame.y.range.lo..=frame.y.range.hi).contains(&value) {
                            canvas.polyline(&[(x - CAP, y), (x + CAP, y)], bar);
                        }
                    }
                }
                let negative = signed && point.y < 0.0;
                let layer = if negative { Layer::Under } else { look.layer };
                canvas.marker(at, Look { layer, ..look }, radius);
            }
        }
        if self.points().next().is_none() {
            frame.say(canvas, "no data");
        }
    }
}
