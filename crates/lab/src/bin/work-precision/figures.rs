//! Figures of error against cost.

use report::figure::{Curve, Figure, Measured, Plot, Spacing, Style};

use crate::results::{Case, Series, StrongPoint};

fn figure(title: String, y_title: &str, plots: Vec<Plot>) -> String {
    let (y_title, size) = (y_title.to_owned(), (268.0, 214.0));
    Figure { title, y_title, size, style: Style::Schemes, plots }.svg()
}

fn curve(scheme: &str, points: impl Iterator<Item = Measured>) -> Curve {
    Curve { name: scheme.to_owned(), note: String::new(), points: points.collect() }
}

fn plot(x_title: String, spacing: Spacing, curves: Vec<Curve>) -> Plot {
    Plot { x_title, spacing, lines: Vec::new(), curves }
}

/// Strong errors against the time and against the steps of a path.
pub fn strong(case: &Case) -> String {
    let curves = |costs: fn(&StrongPoint) -> (f64, f64)| {
        let of = |series: &Series<StrongPoint>| {
            let points = series.points.iter().map(|point| {
                let (x, x_hi) = costs(point);
                Measured {
                    x,
                    x_hi,
                    y: point.work.error,
                    interval: point.work.lo.zip(point.work.hi),
                }
            });
            curve(series.scheme, points)
        };
        case.strong.series.iter().map(of).collect()
    };
    let by_time = curves(|point| (1e6 * point.work.time.min_s, 1e6 * point.work.time.median_s));
    let by_steps = curves(|point| (point.work.steps as f64, point.work.steps as f64));
    let plots = vec![
        plot("processor time of a path, μs".to_owned(), Spacing::Decades, by_time),
        plot("steps of a path".to_owned(), Spacing::Doublings, by_steps),
    ];
    figure(format!("{}: strong error against cost", case.title), "RMS error of y(T)", plots)
}

/// Accuracies of expectations against the time of an estimate, a plot for each test function.
pub fn weak(case: &Case) -> String {
    let plots = case.weak.observables.iter().map(|observable| {
        let curves = observable.series.iter().map(|series| {
            let points = series.curve().into_iter();
            let measured = |(y, x)| Measured { x, x_hi: x, y, interval: None };
            curve(series.scheme, points.map(measured))
        });
        let title = format!("processor time of an estimate of E[{}], s", observable.name);
        plot(title, Spacing::Decades, curves.collect())
    });
    let title = format!("{}: accuracy of expectations against cost", case.title);
    figure(title, "RMS error of the estimate", plots.collect())
}
