//! Curves of error against cost, for figures and for comparisons.

use anyhow::Result;
use precision::results::{Case, StrongSeries, WeakObservable, WeakSeries};

use crate::report::{WorkPlot, WorkPoint, work_figure};

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
pub fn strong_figure(case: &Case) -> Result<String> {
    let curves = |steps: bool| {
        let of = |series: &StrongSeries| {
            let points = series.points.iter().map(|point| WorkPoint {
                cost: if steps { point.steps as f64 } else { MICRO * point.time.min_s },
                cost_hi: if steps { point.steps as f64 } else { MICRO * point.time.median_s },
                error: point.error,
                interval: (point.lo.unwrap_or(point.error), point.hi.unwrap_or(point.error)),
            });
            (series.scheme.clone(), points.collect())
        };
        case.strong.series.iter().map(of).collect()
    };
    let plots = [
        WorkPlot {
            cost: "processor time of a path, μs".to_owned(),
            steps: false,
            curves: curves(false),
        },
        WorkPlot { cost: "steps of a path".to_owned(), steps: true, curves: curves(true) },
    ];
    work_figure(&format!("{}: strong error against cost", case.title), "RMS error of y(T)", &plots)
}

/// Accuracies of expectations against the time of an estimate, a plot for each test function.
pub fn weak_figure(case: &Case) -> Result<String> {
    let plot = |observable: &WeakObservable| {
        let of = |series: &WeakSeries| {
            let points = weak_costs(series).into_iter().map(|(error, cost)| WorkPoint {
                cost,
                cost_hi: cost,
                error,
                interval: (error, error),
            });
            (series.scheme.clone(), points.collect())
        };
        WorkPlot {
            cost: format!("processor time of an estimate of E[{}], s", observable.name),
            steps: false,
            curves: observable.series.iter().map(of).collect(),
        }
    };
    let plots: Vec<WorkPlot> = case.weak.observables.iter().map(plot).collect();
    work_figure(
        &format!("{}: accuracy of expectations against cost", case.title),
        "RMS error of the estimate",
        &plots,
    )
}
