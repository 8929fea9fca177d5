//! Curves of error against cost, for figures and for comparisons.

use precision::results::{Case, StrongSeries, WeakObservable, WeakSeries};
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
    let curves = |steps: bool| {
        let curve = |series: &StrongSeries| {
            let points = series.points.iter().map(|point| {
                let times = (MICRO * point.time.min_s, MICRO * point.time.median_s);
                let (x, x_hi) =
                    if steps { (point.steps as f64, point.steps as f64) } else { times };
                Measured { x, x_hi, y: point.error, interval: point.lo.zip(point.hi) }
            });
            named(&series.scheme, points)
        };
        case.strong.series.iter().map(curve).collect()
    };
    let time = "processor time of a path, μs".to_owned();
    figure(
        format!("{}: strong error against cost", case.title),
        "RMS error of y(T)",
        vec![
            plot(time, Spacing::Decades, curves(false)),
            plot("steps of a path".to_owned(), Spacing::Doublings, curves(true)),
        ],
    )
}

/// Accuracies of expectations against the time of an estimate, a plot for each test function.
pub fn weak_figure(case: &Case) -> Figure {
    let of = |observable: &WeakObservable| {
        let curve = |series: &WeakSeries| {
            let point = |(y, x)| Measured { x, x_hi: x, y, interval: None };
            named(&series.scheme, weak_costs(series).into_iter().map(point))
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

fn named(scheme: &str, points: impl Iterator<Item = Measured>) -> Curve {
    Curve { name: scheme.to_owned(), note: String::new(), points: points.collect() }
}

fn plot(x_title: String, spacing: Spacing, curves: Vec<Curve>) -> Plot {
    Plot { x_title, spacing, lines: Vec::new(), curves }
}

fn figure(title: String, y_title: &str, plots: Vec<Plot>) -> Figure {
    let y_title = y_title.to_owned();
    Figure { title, y_title, size: (268.0, 214.0), style: Style::Schemes, plots }
}
