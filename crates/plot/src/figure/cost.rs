//! Figures of error against cost.

use analysis::compare::{Comparison, ErrorPoint};

use super::chart::{Curve, Figure, Measured, Plot};

/// The strong errors of a comparison with their intervals against the time and against the steps of
/// a path, as an SVG document. Points that the reference does not resolve are left out.
pub fn comparison(comparison: &Comparison) -> String {
    let plot = |x_title: &str, decades, cost: fn(&ErrorPoint) -> Option<f64>| {
        let curves = comparison.candidates.iter().map(|candidate| {
            let resolved = candidate.points.iter().filter(|point| point.resolved);
            let measured = |point: &ErrorPoint| {
                let ErrorPoint { error: y, lo, hi, .. } = *point;
                Some(Measured { x: cost(point)?, y, lo, hi })
            };
            Curve::new(&candidate.scheme, resolved.filter_map(measured))
        });
        Plot { x_title: x_title.into(), decades, curves: curves.collect() }
    };
    let time = |point: &ErrorPoint| Some(1e6 * point.time?.best);
    let plots = vec![
        plot("processor time of a path, μs", true, time),
        plot("steps of a path", false, |point| Some(point.steps as f64)),
    ];
    Figure {
        title: format!("{}: strong error against cost", comparison.system),
        y_title: "RMS error of y(T)".into(),
        signed: false,
        lines: Vec::new(),
        plots,
    }
    .svg()
}
