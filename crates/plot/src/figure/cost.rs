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
        comparison.for_error.candidates.iter().map(curve)
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

#[cfg(test)]
pub(crate) mod tests {
    use analysis::Spread;
    use analysis::compare::{Answer, Choice, Keeps, Outcome, Sampled};

    use super::*;

    /// Two points of one scheme, of which one is not resolved, and an expectation.
    pub(crate) fn small() -> Comparison {
        let point = |steps: u64, resolved| ErrorPoint {
            steps,
            error: 0.5 / steps as f64,
            se: 0.01,
            lo: 0.25 / steps as f64,
            hi: 1.0 / steps as f64,
            resolved,
            deviation: None,
            defect: Some(1e-3),
            time: resolved.then_some(Spread { best: 1e-6, median: 2e-6, worst: 3e-6 }),
        };
        let bias = ErrorPoint {
            error: -0.25,
            lo: 0.125,
            hi: 0.5,
            deviation: Some(2.0),
            time: None,
            ..point(8, true)
        };
        let answer = |quantity: &str, points| {
            let outcome = Outcome::NotReached { at_least_s: 1e-6, needs: None };
            let keeps = Keeps::default();
            Answer {
                quantity: quantity.into(),
                wanted: 1e-3,
                reference_error: 1e-3,
                mean: None,
                candidates: vec![Candidate { scheme: "heun".into(), points, outcome, keeps }],
                choice: Choice::NoneReaches,
            }
        };
        Comparison {
            system: "a<b".into(),
            dimension: 3,
            noises: 1,
            t_end: 1.0,
            damped: true,
            sampled: Sampled::default(),
            for_error: answer("y(T)", vec![point(8, true), point(16, false)]),
            for_expectations: vec![answer("E[y1]", vec![bias])],
            stopped: None,
            clock: "processor time".into(),
            wall_s: 1.0,
        }
    }

    #[test]
    fn a_comparison_is_drawn_against_time_and_steps() {
        let drawn = comparison(&small());
        assert!(drawn.starts_with("<svg") && drawn.contains("a&lt;b: strong error against cost"));
        assert!(drawn.contains("processor time of a path, μs") && drawn.contains("heun"));
    }
}
