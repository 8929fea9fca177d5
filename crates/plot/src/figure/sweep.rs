//! Figures against a parameter: values with their intervals.

use super::*;

/// A value at a parameter, with its interval if there is one.
pub type Sampled = (f64, f64, Option<(f64, f64)>);

/// Ends of the interval of a value; the value itself without one.
pub fn ends(&(_, value, interval): &Sampled) -> [f64; 2] {
    interval.map_or([value; 2], |(lo, hi)| [lo, hi])
}

impl Plain {
    /// Draws a value with its interval.
    pub fn sampled(&mut self, &(x, value, interval): &Sampled, look: Look) {
        let bar = interval.into_iter().flat_map(|(lo, hi)| [(x, lo), (x, hi)]);
        self.line(bar, Stroke::new(look.color, 1.3));
        self.canvas.marker(self.frame.place(x, value), look, 2.4);
    }
}

/// Figure of values against a parameter as an SVG document, each curve with its name in the legend;
/// a single curve has no legend.
pub fn against(
    title: &str,
    x_title: Title<'_>,
    y_title: Title<'_>,
    curves: &[(String, Vec<Sampled>)],
) -> String {
    let (looks, entries) = of_curves(curves.iter().map(|(name, _)| &**name));
    let points = || curves.iter().flat_map(|(_, points)| points);
    let x = x_title.axis(points().map(|point| point.0), 0.04);
    let y = y_title.axis(points().flat_map(ends), 0.06);
    let mut plain = Plain::new(entries, 190.0, (x, Some(x_title.words)), (y, y_title.words));
    for ((_, points), look) in curves.iter().zip(looks) {
        plain.line(points.iter().map(|point| (point.0, point.1)), Stroke::new(look.color, 0.8));
        let inside = |point: &&Sampled| (y.range.lo..=y.range.hi).contains(&point.1);
        points.iter().filter(inside).for_each(|point| plain.sampled(point, look));
    }
    plain.page(title, points().next().is_none())
}
