//! Curves in plain coordinates: components of a path in time, phase portraits.

use super::{
    axis::Range,
    canvas::Stroke,
    frame::{Plain, Title, UNIT},
    legend::of_curves,
};

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
    let names: Vec<&str> = traces.iter().map(|trace| &*trace.name).collect();
    let (looks, entries) = of_curves(&names);
    let points = || traces.iter().flat_map(|trace| &trace.points);
    let x = Range::of(points().map(|point| point.0), UNIT);
    // Times fill the width.
    let of_time = traces.iter().all(|trace| trace.points.is_sorted_by(|a, b| a.0 <= b.0));
    let x = if x.lo < x.hi && of_time { x } else { x.padded(0.04) };
    let y = y_title.range(points().map(|point| point.1), 0.06);
    let mut plain = Plain::new(entries, 190.0, (x, Some(x_title.into())), (y, y_title));
    for (trace, look) in traces.iter().zip(looks) {
        plain.line(trace.points.iter().copied(), Stroke::new(look.color, 1.1));
        let first = plain.places(trace.points.first().copied());
        for at in first.into_iter().filter(|at| plain.frame.holds(*at)) {
            plain.canvas.marker(at, look, 2.8, false);
        }
    }
    plain.page(title, points().next().is_none())
}
