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
