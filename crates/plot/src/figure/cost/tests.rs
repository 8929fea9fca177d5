use analysis::compare::{
    Candidate, Choice, Keeps, Outcome, Sampled, Strong, Time, Verdicts, Weak, WeakObservable,
    WeakPoint,
};

use super::*;

/// Two points of one scheme, of which one is not resolved, and an expectation.
pub(crate) fn small() -> Comparison {
    let time =
        Time { min_s: 1e-6, median_s: 2e-6, max_s: 3e-6, repetitions: 3, paths: 128, failed: 0 };
    let point = |steps: u64, resolved| StrongPoint {
        steps,
        tau: 1.0 / steps as f64,
        error: 0.5 / steps as f64,
        se: 0.01,
        lo: Some(0.25 / steps as f64),
        hi: Some(1.0 / steps as f64),
        resolved,
        ratio: None,
        error_exact_areas: None,
        area_terms: None,
        defects: vec![1e-3],
        time: resolved.then_some(time),
    };
    let weak = WeakPoint {
        steps: 8,
        tau: 0.125,
        bias: -0.25,
        se: 0.01,
        lo: 0.125,
        hi: 0.5,
        standard_deviation: 2.0,
        time: None,
    };
    let sampled = Sampled {
        samples: 512,
        failed: 0,
        failures: Vec::new(),
        reference: "sexp with 64 steps".into(),
    };
    let points = vec![point(8, true), point(16, false)];
    let strong = vec![Series { scheme: "heun".into(), points }];
    let observable = WeakObservable {
        name: "y1".into(),
        exact: None,
        reference_mean: 1.0,
        reference_se: 0.01,
        reference_error: 0.01,
        series: vec![Series { scheme: "heun".into(), points: vec![weak] }],
    };
    let (steps, error, at_least_s) = (8, 0.0625, 1e-6);
    let (resolved, needs, keeps) = (true, None, Keeps::default());
    let outcome = Outcome::NotReached { steps, error, at_least_s, resolved, needs };
    let candidate = Candidate { scheme: "heun".into(), outcome, defect: Some(1e-3), keeps };
    Comparison {
        system: "a<b".into(),
        dimension: 3,
        noises: 1,
        t_end: 1.0,
        damped: true,
        invariants: vec!["C".into()],
        strong: Strong {
            sampled: sampled.clone(),
            reference_error: 1e-3,
            last_difference: 1e-3,
            spread: 1.0,
            series: strong,
        },
        for_error: Verdicts {
            quantity: "y(T)".into(),
            wanted: 1e-3,
            candidates: vec![candidate],
            choice: Choice::NoneReaches,
        },
        weak: Some(Weak { sampled, observables: vec![observable] }),
        for_expectations: Vec::new(),
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
