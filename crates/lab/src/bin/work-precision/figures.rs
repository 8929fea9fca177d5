//! Figures of error against cost.

use report::figure::{Curve, Figure, Measured, Plot, Spacing, Style};

use crate::results::{Case, Series, StrongPoint};

fn figure(title: String, y_title: &str, plots: Vec<Plot>) -> String {
    let (y_title, size) = (y_title.into(), (268.0, 214.0));
    Figure { title, y_title, size, style: Style::Schemes, plots }.svg()
}

fn plot(x_title: String, spacing: Spacing, curves: impl Iterator<Item = Curve>) -> Plot {
    Plot { x_title, spacing, lines: Vec::new(), curves: curves.collect() }
}

/// Strong errors against the time and against the steps of a path.
pub fn strong(case: &Case) -> String {
    let curves = |cost: fn(&StrongPoint) -> (f64, f64)| {
        let measured = move |point: &StrongPoint| {
            let (x, x_hi) = cost(point);
            let interval = point.work.lo.zip(point.work.hi);
            Measured { x, x_hi, y: point.work.error, interval }
        };
        let curve = move |series: &Series<StrongPoint>| {
            Curve::new(series.scheme, series.points.iter().map(measured))
        };
        case.strong.series.iter().map(curve)
    };
    let by_time = curves(|point| (1e6 * point.work.time.min_s, 1e6 * point.work.time.median_s));
    let by_steps = curves(|point| (point.work.steps as f64, point.work.steps as f64));
    let plots = vec![
        plot("processor time of a path, μs".into(), Spacing::Decades, by_time),
        plot("steps of a path".into(), Spacing::Doublings, by_steps),
    ];
    figure(format!("{}: strong error against cost", case.title), "RMS error of y(T)", plots)
}

/// Accuracies of expectations against the time of an estimate, a plot for each test function.
pub fn weak(case: &Case) -> String {
    let plots = case.weak.observables.iter().map(|observable| {
        let curves = observable.curves().into_iter().map(|curve| {
            let points = curve.points.iter().map(|&(error, cost)| Measured::new(cost, error));
            Curve::new(curve.scheme, points)
        });
        let title = format!("processor time of an estimate of E[{}], s", observable.name);
        plot(title, Spacing::Decades, curves)
    });
    let title = format!("{}: accuracy of expectations against cost", case.title);
    figure(title, "RMS error of the estimate", plots.collect())
}
