//! Figures against a parameter: values with their intervals.

use super::{
    canvas::Stroke,
    frame::{Plain, Title},
    legend::of_curves,
};

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
