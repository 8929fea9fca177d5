use analysis::Spread;
use analysis::compare::{Choice, Keeps, Outcome, Sampled};

use super::*;

/// Two points of one scheme, of which one is not resolved.
pub(crate) fn small() -> Comparison {
    let point = |steps: u64, resolved| ErrorPoint {
        steps,
        error: 0.5 / steps as f64,
        se: 0.01,
        lo: 0.25 / steps as f64,
        hi: 1.0 / steps as f64,
        resolved,
        defect: Some(1e-3),
        time: resolved.then_some(Spread { best: 1e-6, median: 2e-6, worst: 3e-6 }),
    };
    Comparison {
        system: "a<b".into(),
        dimension: 3,
        noises: 1,
        t_end: 1.0,
        damped: true,
        wanted: 1e-3,
        sampled: Sampled::default(),
        reference_error: 1e-3,
        candidates: vec![Candidate {
            scheme: "heun".into(),
            points: vec![point(8, true), point(16, false)],
            outcome: Outcome::NotReached { at_least_s: 1e-6, needs: None },
            keeps: Keeps::default(),
        }],
        choice: Choice::NoneReaches,
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
