//! Figures of error against cost.

use analysis::compare::{Candidate, Comparison, ErrorPoint};

use super::{Curve, Figure, Measured, Plot, Spacing, Style};

fn plot(x_title: String, spacing: Spacing, curves: impl Iterator<Item = Curve>) -> Plot {
    Plot { x_title, spacing, lines: Vec::new(), curves: curves.collect() }
}

/// The strong errors of a comparison with their intervals against the time and against the steps of
/// a path, as an SVG document. Points that the reference does not resolve are left out.
pub fn comparison(comparison: &Comparison) -> String {
    let curves = |cost: fn(&ErrorPoint) -> Option<(f64, f64)>| {
        let measured = move |point: &ErrorPoint| {
            let (x, x_hi) = cost(point)?;
            Some(Measured { x, x_hi, y: point.error, interval: Some((point.lo, point.hi)) })
        };
        let curve = move |candidate: &Candidate| {
            let resolved = candidate.points.iter().filter(|point| point.resolved);
            Curve::new(&candidate.scheme, resolved.filter_map(measured))
        };
        comparison.candidates.iter().map(curve)
    };
    let by_time = curves(|point| {
        let time = point.time?;
        Some((1e6 * time.best, 1e6 * time.median))
    });
    let by_steps = curves(|point| Some((point.steps as f64, point.steps as f64)));
    let plots = vec![
        plot("processor time of a path, μs".into(), Spacing::Decades, by_time),
        plot("steps of a path".into(), Spacing::Doublings, by_steps),
    ];
    Figure {
        title: format!("{}: strong error against cost", comparison.system),
        y_title: "RMS error of y(T)".into(),
        size: (268.0, 214.0),
        style: Style::Schemes,
        plots,
    }
    .svg()
}
