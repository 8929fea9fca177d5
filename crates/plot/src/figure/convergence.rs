//! Errors against the step size, or cost against accuracy.

use real::elementary::{ln, powf};
use stats::{Point, Rate};

use super::*;
use crate::series::{Kind, QUANTILE, Series, main_quantity};

/// The figure of strong or weak errors against the step size, or of path-steps against accuracy, as
/// an SVG document.
///
/// For strong errors it shows the error at the final time of all schemes, for weak errors all
/// quantities. Fitted orders stand in the legend; grey lines show the slopes 1/2 and 1, whichever
/// is nearer to each order, and 2 for weak orders above 3/2.
///
/// ```
/// use plot::{Kind, Series, figure::convergence};
/// use stats::Point;
///
/// let points = [0.1, 0.05, 0.025].map(|tau| Point::normal(tau, 0.3 * tau, 0.001 * tau));
/// let series = Series {
///     scheme: "my-scheme".into(),
///     quantity: "y(T)".into(),
///     points: points.to_vec(),
///     rate: None,
///     max_relative_defect: None,
/// };
/// let svg = convergence("Errors of my scheme", Kind::Strong, &[series]);
/// assert!(svg.starts_with("<svg") && svg.contains("my-scheme") && svg.contains("slope 1"));
/// ```
pub fn convergence(title: &str, kind: Kind, series: &[Series]) -> String {
    let (weak, cost) = (kind == Kind::Weak, kind == Kind::Cost);
    let quantity = main_quantity(series);
    let (mut curves, mut trends) = (Vec::new(), Vec::new());
    for series in series.iter().filter(|s| weak || s.quantity == quantity) {
        let rate = series.rate.as_ref().filter(|rate| rate.estimate.is_finite());
        let name = if weak { &series.quantity } else { &series.scheme };
        let mut curve = Curve::new(name, series.points.iter().filter_map(measured));
        curve.note = rate.map(order).unwrap_or_default();
        let points = curve.trend();
        let fitted = rate.map_or_else(|| overall_order(&points), |rate| rate.estimate);
        // Intervals of weak orders are too wide to choose between slopes 1/2 and 1.
        let order = match weak {
            true if rate.is_some_and(|rate| rate.lo > 1.5) => 2.0,
            false if fitted < 0.75 => 0.5,
            _ => 1.0,
        };
        trends.push((order, points));
        curves.push(curve);
    }
    let (x_title, y_title) = match kind {
        Kind::Cost => ("half-width ε of the 95 % interval", "path-steps".into()),
        Kind::Weak => ("step size τ", "|weak error|".into()),
        _ => ("step size τ", format!("RMS error of {quantity}")),
    };
    let plots = vec![Plot { x_title: x_title.into(), decades: cost, curves }];
    let lines = if cost { Vec::new() } else { reference_slopes(&trends) };
    Figure { title: title.into(), y_title, signed: weak, lines, plots }.svg()
}

fn measured(point: &Point) -> Option<Measured> {
    let (x, y, half, ends) = match *point {
        Point::Error { tau, value, se, lo, hi, .. } => {
            (tau, value, QUANTILE * se.abs(), lo.zip(hi))
        }
        Point::Cost { accuracy, path_steps } => (accuracy, path_steps as f64, 0.0, None),
        Point::Value { .. } => return None,
    };
    let ends = ends.filter(|(lo, hi)| *lo >= 0.0 && hi.is_finite());
    let known = half.is_finite() && half != 0.0;
    let (lo, hi) = if known { ends.unwrap_or((y - half, y + half)) } else { (y, y) };
    Some(Measured { x, y, lo, hi })
}

/// Formats an order with the half-width of its interval, which is never rounded to zero.
pub fn order(rate: &Rate) -> String {
    let estimate = format!("{:.2}", rate.estimate).replace('-', "−");
    match 0.5 * (rate.hi - rate.lo) {
        half if half.is_finite() => format!("{estimate} ± {:.2}", half.max(0.01)),
        _ => estimate,
    }
}

/// The order between the first point and the last; NaN without two points.
pub fn overall_order(points: &[(f64, f64)]) -> f64 {
    match points {
        [first, .., last] => ln(last.1 / first.1) / ln(last.0 / first.0),
        _ => f64::NAN,
    }
}

/// The lines of slope 2, 1 and 1/2 that curves need, given by their order and their points.
///
/// The first line lies below all points, the others above.
pub fn reference_slopes(trends: &[(f64, Vec<(f64, f64)>)]) -> Vec<Line> {
    /// The distance of a line from the nearest point, as a factor.
    const CLEARANCE: f64 = 1.8;
    let mut lines = Vec::new();
    for (power, name) in [(2.0, "slope 2"), (1.0, "slope 1"), (0.5, "slope 1/2")] {
        let points = trends.iter().flat_map(|(_, points)| points);
        let ratios = points.map(|(tau, error)| error / powf(*tau, power));
        let constant = match lines.is_empty() {
            true => ratios.reduce(f64::min).map(|ratio| ratio / CLEARANCE),
            false => ratios.reduce(f64::max).map(|ratio| ratio * CLEARANCE),
        };
        let shown = trends.iter().any(|(order, _)| *order == power);
        lines.extend(constant.filter(|_| shown).map(|constant| Line { name, constant, power }));
    }
    lines
}
