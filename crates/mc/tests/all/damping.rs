//! Dampings that oscillate or have a pulse within the steps: whether the steps are said to resolve
//! them.

use expectation::{Expect, ExpectSettings, Expectation, WarningKind};
use mc::{DampingResolution, Observable, Setup};
use noise::StreamKey;
use schemes::{Heun, Scheme, Sexp};
use systems::{Constant, Cosine, Damping, DampingFunction, Problem};

use crate::statistical::{judged::Kubo, random_points};

fn problem<G: Damping>(damping: G) -> Problem<Kubo, G, 2> {
    Problem::new(Kubo { omega: 1.0, sigma: 0.5 }, damping, [1.0, 0.0], 1.0).unwrap()
}

/// E[y₁(1)] = cos 1·e^{−σ²/2 − ∫γ} with σ = ½.
fn exact(integral: f64) -> f64 {
    1f64.cos() * (-0.125 - integral).exp()
}

fn expected<G: Damping>(
    scheme: &dyn Scheme<Kubo, 2, 1>,
    problem: &Problem<Kubo, G, 2>,
    max_level: usize,
) -> Expectation {
    of(scheme, problem, max_level, &Observable { name: "y1", function: |y| y[0] }, 0.02)
}

fn of<G: Damping>(
    scheme: &dyn Scheme<Kubo, 2, 1>,
    problem: &Problem<Kubo, G, 2>,
    max_level: usize,
    phi: &Observable<2>,
    accuracy: f64,
) -> Expectation {
    let (key, coarsest_steps) = (StreamKey { seed: 2, experiment: 5 }, 8);
    let settings = ExpectSettings {
        key,
        coarsest_steps,
        max_level,
        random_points: true,
        ..Default::default()
    };
    Expect::with_scheme(Setup::of(problem, scheme)).with(settings).run(&[phi], accuracy).unwrap()
}

fn warns(expectation: &Expectation) -> bool {
    random_points::warns(expectation, WarningKind::Damping)
}

fn covers(expectation: &Expectation, exact: f64) -> bool {
    let (lower, upper) = expectation.estimates[0].interval();
    (lower..=upper).contains(&exact)
}

#[test]
fn a_rate_that_oscillates_within_the_steps_is_not_resolved() {
    // Rates at multiples of 1/256 are all one: up to 128 steps the damping looks constant.
    let problem = problem(Cosine::new(1.0, 512.0 * std::f64::consts::PI).unwrap());
    let coarse = expected(&Heun, &problem, 3);
    assert!(!coarse.reached() && warns(&coarse), "{coarse:?}");
    assert!(!covers(&coarse, exact(0.0)), "the problem is not hard enough");
    let fine = expected(&Heun, &problem, 12);
    assert!(fine.reached() && !warns(&fine) && covers(&fine, exact(0.0)), "{fine:?}");
    // What reads the exact integrals sees all of it.
    let exactly = expected(&Sexp, &problem, 12);
    assert!(exactly.reached() && exactly.levels.len() == 4 && covers(&exactly, exact(0.0)));
}

#[test]
#[ignore = "long: run by the gate"]
fn a_pulse_between_the_nodes_of_a_quadrature_is_not_resolved() {
    // ∫γ = 1 from a pulse of width 1/2500, which two nodes in 1/128 do not see.
    let pulse = |t: f64| if (t - 0.5314).abs() < 0.0002 { 2500.0 } else { 0.0 };
    let problem = problem(DampingFunction::new(pulse, 2).unwrap());
    let coarse = expected(&Sexp, &problem, 3);
    assert!(!coarse.reached() && warns(&coarse) && !covers(&coarse, exact(1.0)), "{coarse:?}");
    let fine = expected(&Sexp, &problem, 12);
    assert!(!fine.reached() || covers(&fine, exact(1.0)), "{fine:?}");
}

/// A pulse that rates show nowhere, with ∫γ = 1 by its closed form.
struct Hidden;

impl Damping for Hidden {
    fn rate(&self, _: f64) -> f64 {
        0.0
    }
    fn integral(&self, a: f64, b: f64) -> f64 {
        f64::from(u8::from(a < 0.5137 && 0.5137 <= b))
    }
    fn describe(&self) -> String {
        "hidden".into()
    }
}

#[test]
fn a_closed_integral_is_compared_for_schemes_that_read_rates() {
    let problem = problem(Hidden);
    let result = expected(&Heun, &problem, 4);
    assert!(!result.reached() && warns(&result) && !covers(&result, exact(1.0)), "{result:?}");
}

#[test]
fn a_small_defect_matters_to_a_function_that_multiplies_it() {
    // ∫γ = 0, and 0.01 by rates at multiples of 1/8192: |y|² is wrong by a fiftieth, cos 200|y|² by
    // four radians.
    let fast = Cosine::new(0.01, 16_384.0 * std::f64::consts::PI).unwrap();
    let problem = problem(fast);
    let function = |y: [f64; 2]| (200.0 * (y[0] * y[0] + y[1] * y[1])).cos();
    let sensitive = of(&Heun, &problem, 6, &Observable { name: "phi", function }, 0.1);
    assert!(!sensitive.reached() && warns(&sensitive), "{sensitive:?}");
    assert!(!covers(&sensitive, 200f64.cos()), "the problem is not hard enough");
}

#[test]
fn a_wave_that_nearly_repeats_with_the_steps_is_not_resolved() {
    // 64 steps see a slow wave in the place of one with nearly a period in a step.
    let unresolved = |periods: f64| {
        let problem = problem(Cosine::new(0.3, 2.0 * std::f64::consts::PI * periods).unwrap());
        DampingResolution::new(&Setup::of(&problem, &Heun), 64).unresolved(0)
    };
    for periods in [64.0, 64.3, 63.6, 128.4] {
        assert!(unresolved(periods).is_some_and(|by| by > 0.03), "{periods}");
    }
    for periods in [0.3, 2.0, 4.7, 8.0] {
        assert_eq!(unresolved(periods), None, "{periods}");
    }
}

#[test]
fn smooth_dampings_and_jumps_are_resolved_by_few_steps() {
    let resolved = |damping: &dyn Damping| {
        let problem = problem(damping);
        let seen = DampingResolution::new(&Setup::of(&problem, &Heun), 8);
        (2..8).all(|level| seen.unresolved(level).is_none())
    };
    assert!(resolved(&Constant::new(30.0).unwrap()));
    // What is left of many steps is round-off.
    let constant = problem(Constant::new(0.7).unwrap());
    let seen = DampingResolution::new(&Setup::of(&constant, &Heun), 512);
    assert_eq!((6..12).find(|&level| seen.unresolved(level).is_some()), None);
    assert!(resolved(&Cosine::new(3.0, 7.0).unwrap()));
    for at in [0.3, 1.0 / 3.0, 0.5, 0.7, 0.501] {
        let jump = move |t: f64| if t < at { 4.0 } else { -1.0 };
        assert!(resolved(&DampingFunction::new(jump, 3).unwrap()), "{at}");
    }
}
