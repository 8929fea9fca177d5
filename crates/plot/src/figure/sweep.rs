//! Figures against a parameter: values with their intervals, and small multiples in time.

use study::Series;

use super::{
    canvas::{Align, Canvas, Stroke},
    frame::{BELOW, Frame, Plain, RIGHT, Title, WIDTH},
    legend::of_curves,
    study::{draw_bands, ranges},
    ticks::Ticks,
};
use crate::label::Label;

/// A value at a parameter, with its interval if there is one.
pub type Sampled = (f64, f64, Option<(f64, f64)>);

/// Figure of values against a parameter as an SVG document, each curve with its name in the legend;
/// a single curve has no legend.
pub fn against(
    title: &str,
    x_title: Title<'_>,
    y_title: Title<'_>,
    curves: &[(String, Vec<Sampled>)],
) -> String {
    let names: Vec<&str> = curves.iter().map(|(name, _)| &**name).collect();
    let (looks, entries) = of_curves(&names);
    let points = || curves.iter().flat_map(|(_, points)| points);
    let x = x_title.range(points().map(|point| point.0), 0.04);
    let ends = |&(_, value, interval): &Sampled| interval.map_or([value; 2], |(lo, hi)| [lo, hi]);
    let y = y_title.range(points().flat_map(ends), 0.06);
    let mut plain = Plain::new(entries, 190.0, (x, Some(x_title)), (y, y_title));
    for ((_, points), look) in curves.iter().zip(looks) {
        plain.line(points.iter().map(|point| (point.0, point.1)), Stroke::new(look.color, 0.8));
        for &(x, value, interval) in
            points.iter().filter(|point| y.lo <= point.1 && point.1 <= y.hi)
        {
            let bar = interval.map(|(lo, hi)| [(x, lo), (x, hi)]);
            plain.line(bar.into_iter().flatten(), Stroke::new(look.color, 1.3));
            let at = plain.frame.place(x, value);
            plain.canvas.marker(at, look, 2.4, false);
        }
    }
    plain.page(title, points().next().is_none())
}

/// Number of small plots in a row.
const COLUMNS: usize = 3;
/// Room for the labels on the left.
const LEFT: f64 = 42.0;
/// Room between two plots, and above each for its name.
const GAP: f64 = 12.0;
const NAME: f64 = 14.0;
const HEIGHT: f64 = 74.0;

/// Small multiples of an observable in time as an SVG document: bands, median and mean as in
/// [`bands`](super::bands()), a plot for each name, all with the same axes.
pub fn multiples(title: &str, y_title: Title<'_>, panels: &[(String, &Series)]) -> String {
    let x_title = Title::from("");
    let all = panels.iter().flat_map(|(_, series)| &series.points);
    let [times, values] = ranges(all, x_title, y_title);
    let columns = COLUMNS.min(panels.len()).max(1);
    let width = (WIDTH - LEFT - RIGHT - GAP * (columns - 1) as f64) / columns as f64;
    let mut canvas = Canvas::default();
    let pitch = NAME + HEIGHT + GAP;
    for (k, (name, series)) in panels.iter().enumerate() {
        let (row, column) = (k / columns, k % columns);
        let (left, top) = (LEFT + (width + GAP) * column as f64, NAME + pitch * row as f64);
        let frame = Frame {
            x: x_title.axis(times, left, left + width),
            y: y_title.axis(values, top + HEIGHT, top),
        };
        let mut y = y_title.ticks(values, 3);
        if column > 0 {
            y.major.iter_mut().for_each(|(_, label)| *label = Label::words(""));
            y.factor = None;
        }
        // Nothing stands below it.
        let is_last = k + columns >= panels.len();
        let x_title = is_last.then_some(if column == columns / 2 { "time t" } else { "" });
        frame.draw(&mut canvas, (&Ticks::decimal(times, 3), x_title), (&y, None));
        canvas.label(&Label::words(name), (left + 0.5 * width, top - 7.0), 8.5, Align::Middle);
        draw_bands(&mut canvas, &frame, &series.points);
    }
    let rows = panels.len().div_ceil(columns) as f64;
    canvas.page((WIDTH, pitch * rows - GAP + BELOW), title)
}
