//! Curves of error against cost, for figures and for comparisons.

use precision::results::{Case, StrongPoint, StrongSeries, WeakObservable, WeakSeries};
use report::figure::{Curve, Figure, Measured, Plot, Spacing, Style};

/// Seconds to microseconds.
const MICRO: f64 = 1e6;

/// (error, microseconds a path) of a strong curve.
pub fn strong_costs(series: &StrongSeries) -> Vec<(f64, f64)> {
    series.points.iter().map(|point| (point.error, MICRO * point.time.min_s)).collect()
}

/// (accuracy, seconds) of a weak curve.
pub fn weak_costs(series: &WeakSeries) -> Vec<(f64, f64)> {
    series.costs.iter().map(|cost| (cost.accuracy, cost.cost_s)).collect()
}

/// Strong errors against the time and against the steps of a path.
pub fn strong_figure(case: &Case) -> Figure {
    let curves = |cost: fn(&StrongPoint) -> (f64, f64)| {
        let point = |point: &StrongPoint| {
            let (x, x_hi) = cost(point);
            Measured { x, x_hi, y: point.error, interval: point.lo.zip(point.hi) }
        };
        let curve = |s: &StrongSeries| Curve::new(&s.scheme, s.points.iter().map(point));
        case.strong.series.iter().map(curve).collect()
    };
    let time = curves(|point| (MICRO * point.time.min_s, MICRO * point.time.median_s));
    let steps = curves(|point| (point.steps as f64, point.steps as f64));
    figure(
        format!("{}: strong error against cost", case.title),
        "RMS error of y(T)",
        vec![
            plot("processor time of a path, μs".to_owned(), Spacing::Decades, time),
            plot("steps of a path".to_owned(), Spacing::Doublings, steps),
        ],
    )
}

/// Accuracies of expectations against the time of an estimate, a plot for each test function.
pub fn weak_figure(case: &Case) -> Figure {
    let of = |observable: &WeakObservable| {
        let curve = |series: &WeakSeries| {
            let points = weak_costs(series).into_iter();
            Curve::new(&series.scheme, points.map(|(error, cost)| Measured::new(cost, error)))
        };
        let title = format!("processor time of an estimate of E[{}], s", observable.name);
        plot(title, Spacing::Decades, observable.series.iter().map(curve).collect())
    };
    figure(
        format!("{}: accuracy of expectations against cost", case.title),
        "RMS error of the estimate",
        case.weak.observables.iter().map(of).collect(),
    )
}

fn plot(x_title: String, spacing: Spacing, curves: Vec<Curve>) -> Plot {
    Plot { x_title, spacing, lines: Vec::new(), curves }
}

fn figure(title: String, y_title: &str, plots: Vec<Plot>) -> Figure {
    let y_title = y_title.to_owned();
    Figure { title, y_title, size: (268.0, 214.0), style: Style::Schemes, plots }
}
