//! Curves in plain coordinates: components of a path in time, phase portraits.

use super::*;

/// A curve with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Name of the curve in the legend.
    pub name: String,
    /// Points of the curve; one that is not finite interrupts the line.
    pub points: Vec<(f64, f64)>,
}

/// Figure of curves as an SVG document. A marker stands where each begins. A single curve has no
/// legend.
pub fn lines<'a>(
    title: &str,
    x_title: &str,
    y_title: impl Into<Title<'a>>,
    traces: &[Trace],
) -> String {
    let y_title = y_title.into();
    let (looks, entries) = of_curves(traces.iter().map(|trace| &*trace.name));
    let points = || traces.iter().flat_map(|trace| &trace.points);
    // Times fill the width.
    let of_time = traces.iter().all(|trace| trace.points.is_sorted_by(|a, b| a.0 <= b.0));
    let x = Axis::of(points().map(|point| point.0), if of_time { 0.0 } else { 0.04 });
    let y = y_title.axis(points().map(|point| point.1), 0.06);
    let mut plain = Plain::new(entries, 190.0, (x, Some(x_title)), (y, y_title.words));
    for (trace, look) in traces.iter().zip(looks) {
        plain.line(trace.points.iter().copied(), Stroke::new(look.color, 1.1));
        let first = trace.points.first().map(|&(x, y)| plain.frame.place(x, y));
        if let Some(at) = first.filter(|at| plain.frame.holds(*at)) {
            plain.canvas.marker(at, look, 2.8);
        }
    }
    plain.page(title, points().next().is_none())
}
