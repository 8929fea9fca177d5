//! Errors against the step size, or cost against accuracy.

use stats::{Point, Rate};

use super::{
    chart::{COLUMN, Curve, Figure, Line, Measured, Plot, Style},
    ticks::Spacing,
};
use crate::{
    Kind, Series,
    series::{QUANTILE, distinct, main_quantity},
};

/// The figure of strong or weak errors against the step size, or of path-steps against accuracy.
///
/// Of strong errors it shows the error at the final time, of weak errors all quantities, in a plot
/// for each scheme. Fitted orders stand in the legend, unless it is that of several plots; grey
/// lines show the slopes 1/2 and 1, whichever is nearer to each order, and 2 for weak orders above
/// 3/2.
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
/// let svg = convergence("Errors of my scheme", Kind::Strong, &[series]).svg();
/// assert!(svg.starts_with("<svg") && svg.contains("my-scheme") && svg.contains("slope 1"));
/// ```
pub fn convergence(title: &str, kind: Kind, series: &[Series]) -> Figure {
    let (weak, cost) = (kind == Kind::Weak, kind == Kind::Cost);
    let quantity = main_quantity(series);
    let drawn: Vec<&Series> = series.iter().filter(|s| weak || s.quantity == quantity).collect();
    let schemes = distinct(drawn.iter().map(|series| series.scheme.as_str()));
    let several = weak && schemes.len() > 1;
    let curve = |series: &&Series| Curve {
        name: if weak { series.quantity.clone() } else { series.scheme.clone() },
        note: rate(series).filter(|_| !several).map_or(String::new(), order),
        points: series.points.iter().filter_map(measured).collect(),
    };
    let curves: Vec<Curve> = drawn.iter().map(curve).collect();
    let trends = drawn.iter().zip(&curves).map(|(series, curve)| {
        let points = curve.trend();
        let fitted = || rate(series).map_or_else(|| overall_order(&points), |rate| rate.estimate);
        // Intervals of weak orders are too wide to choose between slopes 1/2 and 1.
        let two = rate(series).is_some_and(|rate| rate.lo > 1.5);
        let order = match weak {
            true if two => 2.0,
            false if fitted() < 0.75 => 0.5,
            _ => 1.0,
        };
        (order, points)
    });
    let lines = reference_slopes(&trends.filter(|_| !cost).collect::<Vec<_>>());
    let (x_title, y_title) = match kind {
        Kind::Cost => ("half-width ε of the 95 % interval", "path-steps".into()),
        Kind::Weak => ("step size τ", "|weak error|".into()),
        _ => ("step size τ", format!("RMS error of {quantity}")),
    };
    let spacing = if cost { Spacing::Decades } else { Spacing::Doublings };
    let plot = |x_title: String, curves| Plot { x_title, spacing, lines: lines.clone(), curves };
    let of_scheme = |scheme: &&str| {
        let own = drawn.iter().filter(|series| series.scheme == *scheme);
        plot(format!("{x_title}, {scheme}"), own.map(curve).collect())
    };
    let plots = match several {
        true => schemes.iter().map(of_scheme).collect(),
        false => vec![plot(x_title.into(), curves)],
    };
    Figure {
        title: title.into(),
        y_title,
        size: COLUMN,
        style: if weak { Style::Signed } else { Style::Schemes },
        plots,
    }
}

fn rate(series: &Series) -> Option<&Rate> {
    series.rate.as_ref().filter(|rate| rate.estimate.is_finite())
}

fn measured(point: &Point) -> Option<Measured> {
    match *point {
        Point::Error { tau, value, se, lo, hi, .. } => {
            let half = QUANTILE * se.abs();
            let ends = lo.zip(hi).filter(|(lo, hi)| *lo >= 0.0 && hi.is_finite());
            let ends = ends.unwrap_or((value - half, value + half));
            let interval = (half.is_finite() && half != 0.0).then_some(ends);
            Some(Measured { interval, ..Measured::new(tau, value) })
        }
        Point::Cost { accuracy, path_steps } => Some(Measured::new(accuracy, path_steps as f64)),
        Point::Value { .. } => None,
    }
}

/// An order with the half-width of its interval, which is never rounded to zero.
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
        [first, .., last] => (last.1 / first.1).ln() / (last.0 / first.0).ln(),
        _ => f64::NAN,
    }
}

/// The lines of slope 2, 1 and 1/2 that curves need, given by their order and their points.
///
/// The first line lies below all points, the others above.
pub fn reference_slopes(trends: &[(f64, Vec<(f64, f64)>)]) -> Vec<Line> {
    /// The distance of a line from the nearest point, as a factor.
    const CLEARANCE: f64 = 1.8;
    let shown = [(2.0, "slope 2"), (1.0, "slope 1"), (0.5, "slope 1/2")]
        .into_iter()
        .filter(|(power, _)| trends.iter().any(|(order, _)| order == power));
    let line = |(place, (power, name)): (usize, (f64, &str))| {
        let points = trends.iter().flat_map(|(_, points)| points);
        let ratios = points.map(|(tau, error)| error / tau.powf(power));
        let constant = match place {
            0 => ratios.reduce(f64::min)? / CLEARANCE,
            _ => ratios.reduce(f64::max)? * CLEARANCE,
        };
        Some(Line { name: name.into(), constant, power })
    };
    shown.enumerate().filter_map(line).collect()
}
