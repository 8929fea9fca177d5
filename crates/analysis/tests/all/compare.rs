//! `compare` on Kubo's oscillator, whose strong errors are known, with wrong schemes as twins.

use analysis::OtherNoise;
use analysis::compare::{
    Candidates, Choice, CompareError, CompareSettings, Comparison, ErrorPoint, Expectations,
    Outcome, compare,
};
use mc::{Observable, bind};
use noise::{BlockNoise, Noise, StreamKey, Truncation};
use schemes::{EulerMaruyama, Heun, Midpoint, Sexp, Step};
use systems::paper::rigid_body_three_noises;

use crate::orders::kubo;

const OMEGA: f64 = 1.0;
const SIGMA: f64 = 0.7;

fn settings(error: f64, seed: u64) -> CompareSettings<'static> {
    let key = StreamKey { seed, experiment: 11 };
    let settings = CompareSettings::new(error, Truncation::new(4).unwrap(), key);
    CompareSettings { samples: 256, ..settings }
}

/// A complex number.
type Complex = (f64, f64);

fn product(a: Complex, b: Complex) -> Complex {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

/// The strong error at T = 1 of a scheme that multiplies y by a(θ, τ) in a step, with θ = ωτ + σΔW,
/// where the solution is multiplied by e^{iθ}: E|Πa − Πe^{iθ}|² = (E|a|²)^N + 1 − 2 Re (E a
/// e^{−iθ})^N.
fn exact(steps: u64, a: fn(f64, f64) -> Complex) -> f64 {
    let tau = 1.0 / steps as f64;
    let (mut square, mut cross) = (0.0, (0.0, 0.0));
    // The trapezoidal rule is exact to round-off for Gaussians.
    for k in -400..=400 {
        let x = f64::from(k) * 0.02;
        let weight = 0.02 * (-0.5 * x * x).exp() / (2.0 * std::f64::consts::PI).sqrt();
        let theta = OMEGA * tau + SIGMA * tau.sqrt() * x;
        let a = a(theta, tau);
        square += weight * (a.0 * a.0 + a.1 * a.1);
        let turned = product(a, (theta.cos(), -theta.sin()));
        cross = (cross.0 + weight * turned.0, cross.1 + weight * turned.1);
    }
    let mut power = (1.0, 0.0);
    for _ in 0..steps {
        power = product(power, cross);
    }
    (square.powi(steps as i32) + 1.0 - 2.0 * power.0).sqrt()
}

fn heun(theta: f64, _: f64) -> Complex {
    (1.0 - 0.5 * theta * theta, theta)
}

fn em(theta: f64, tau: f64) -> Complex {
    (1.0 - 0.5 * SIGMA * SIGMA * tau, theta)
}

/// (1 + iθ/2)/(1 − iθ/2), of the midpoint rule and, without damping, of `sexp`.
fn cayley(theta: f64, _: f64) -> Complex {
    let s = 0.25 * theta * theta;
    ((1.0 - s) / (1.0 + s), theta / (1.0 + s))
}

#[test]
fn intervals_contain_the_strong_errors_that_are_known() {
    let problem = kubo(OMEGA, SIGMA);
    let candidates = Candidates::against(bind(&problem, &Sexp))
        .and(bind(&problem, &Sexp))
        .and(bind(&problem, &Midpoint))
        .and(bind(&problem, &Heun))
        .and(bind(&problem, &EulerMaruyama));
    let (mut points, mut misses) = (0, Vec::new());
    for seed in 1..=6 {
        let comparison =
            compare(&mc::Problem::of(&problem), &candidates, &settings(0.02, seed)).unwrap();
        assert!(comparison.recommended().is_some(), "{comparison}");
        let exact_error = [cayley, cayley, heun, em];
        for (one, a) in comparison.for_error.candidates.iter().zip(exact_error) {
            // Truncated increments are those of coarse steps.
            for point in one.points.iter().filter(|point| point.resolved && point.steps >= 16) {
                let exact = exact(point.steps, a);
                points += 1;
                if !(point.lo <= exact && exact <= point.hi) {
                    misses.push(format!("{} {exact} {point:?}", one.scheme));
                }
            }
        }
    }
    assert!(points > 40 && 10 * misses.len() <= points, "{points} {misses:?}");
}

#[test]
fn all_schemes_are_compared_and_expectations_are_priced() {
    let problem = kubo(OMEGA, SIGMA);
    let y1 = Observable { name: "y1", function: |y: [f64; 2]| y[0] };
    let wanted = Expectations { observables: &[&y1], accuracy: 0.02 };
    let settings = CompareSettings { expectations: Some(wanted), ..settings(0.02, 1) };
    let comparison =
        compare(&mc::Problem::of(&problem), &Candidates::all(&problem), &settings).unwrap();
    let names: Vec<&str> =
        comparison.for_error.candidates.iter().map(|one| one.scheme.as_str()).collect();
    // One noise commutes, and B is constant.
    assert_eq!(names, ["sexp", "sexp-li", "midpoint", "heun", "em"]);
    let text = comparison.to_string();
    for words in ["in y(T)", "in E[y1]", "scheme", "Take ", "kubo: D = 2, M = 1"] {
        assert!(text.contains(words), "{words} is not in\n{text}");
    }
    let expectation = &comparison.for_expectations[0];
    assert!(expectation.recommended().is_some_and(|scheme| names.contains(&scheme)), "{text}");
    // E y₁(1) = cos ω e^{−σ²/2}.
    let exact = OMEGA.cos() * (-0.5 * SIGMA * SIGMA).exp();
    let [mean, se] = expectation.mean.unwrap();
    let error = (mean - exact).abs();
    assert!(error < 4.0 * se + expectation.reference_error, "{expectation:?}");
    // Every candidate is priced against the cheapest, and the one taken keeps no less.
    let Choice::Take { scheme, cheapest } = comparison.for_error.choice else { panic!("{text}") };
    let keeps = |n: usize| comparison.for_error.candidates[n].keeps;
    assert!(keeps(scheme) >= keeps(cheapest), "{text}");
    let ratio = comparison.for_error.ratio(scheme, cheapest);
    assert!(ratio.is_some_and(|(ratio, lo, _)| ratio >= 1.0 && lo <= 1.1), "{text}");
    assert!(
        comparison
            .for_error
            .ratio(0, cheapest)
            .is_some_and(|(ratio, lo, _)| lo <= ratio && ratio >= 1.0)
    );

    let read: Comparison =
        serde_json::from_str(&serde_json::to_string(&comparison).unwrap()).unwrap();
    assert_eq!(read, comparison);
}

/// `nv` is a candidate by flows of parts, and keeps the Casimir.
#[test]
fn weak_order_two_is_compared_with_flows_of_parts() {
    let problem = rigid_body_three_noises(1.0);
    let cos = Observable { name: "cos y3", function: |y: [f64; 3]| y[2].cos() };
    let wanted = Expectations { observables: &[&cos], accuracy: 5e-3 };
    let key = StreamKey { seed: 1, experiment: 19 };
    let settings = CompareSettings {
        samples: 128,
        expectations: Some(wanted),
        ..CompareSettings::new(0.1, Truncation::new(4).unwrap(), key)
    };
    let all = Candidates::all(&problem);
    let parts = Candidates::by_parts(&problem);
    let areas = ["sexp", "sexp-levy", "sexp-li", "sexp-li-levy"];
    let others = ["midpoint", "heun", "em"];
    for (candidates, flows) in [(all, &[][..]), (parts, &["split", "nv"])] {
        let found = compare(&mc::Problem::of(&problem), &candidates, &settings).unwrap();
        let names: Vec<&str> =
            found.for_error.candidates.iter().map(|one| one.scheme.as_str()).collect();
        assert_eq!(names, [&areas, flows, &others].concat());
        let Some(nv) = names.iter().position(|name| *name == "nv") else { continue };
        assert!(found.for_error.candidates[nv].keeps.casimirs, "{found}");
        let verdicts = &found.for_expectations[0];
        assert!(matches!(verdicts.candidates[nv].outcome, Outcome::Reached { .. }), "{found}");
    }
}

/// Everything but times.
fn errors(comparison: &Comparison) -> Vec<ErrorPoint> {
    let points = comparison.for_error.candidates.iter().flat_map(|one| one.points.clone());
    points.map(|point| ErrorPoint { time: None, ..point }).collect()
}

#[test]
fn errors_are_the_same_bits_and_follow_the_seed() {
    let problem = kubo(OMEGA, SIGMA);
    let candidates = Candidates::against(bind(&problem, &Sexp))
        .and(bind(&problem, &Heun))
        .and(bind(&problem, &EulerMaruyama));
    let of = |seed| {
        errors(&compare(&mc::Problem::of(&problem), &candidates, &settings(0.05, seed)).unwrap())
    };
    assert_eq!(of(1), of(1));
    assert_ne!(of(1), of(2));
}

/// Noise that is larger by a factor.
fn amplified(factor: f64) -> impl Fn(&Step, &BlockNoise<1>, usize) -> Noise<1> + Send + Sync {
    move |_, noise, p| Noise::increments(noise.path(p).increments.map(|dw| factor * dw))
}

#[test]
fn a_wrong_coefficient_is_not_recommended_and_a_wrong_reference_is_named() {
    let problem = kubo(OMEGA, SIGMA);
    // Heun's method with noise that is a tenth of a percent too strong: its strong error is below
    // the wanted one, and it converges to something else.
    let wrong = OtherNoise { scheme: &Heun, noise: amplified(1.001) };
    let failing = OtherNoise { scheme: &Heun, noise: amplified(f64::NAN) };
    let candidates = Candidates::against(bind(&problem, &Sexp))
        .and(bind(&problem, &wrong))
        .and(bind(&problem, &failing))
        .and(bind(&problem, &Sexp));
    let comparison = compare(&mc::Problem::of(&problem), &candidates, &settings(0.02, 1)).unwrap();
    let [first, second, third] = &comparison.for_error.candidates[..] else { panic!() };
    assert!(matches!(first.outcome, Outcome::Inconsistent(_)), "{comparison}");
    assert!(matches!(second.outcome, Outcome::Fails(_)), "{comparison}");
    assert!(matches!(third.outcome, Outcome::Reached { .. }), "{comparison}");
    assert_eq!(comparison.recommended(), Some("sexp"));
    // No path of the others is lost to the scheme that fails.
    assert_eq!(comparison.sampled.failed, 0);

    let candidates = Candidates::against(bind(&problem, &wrong)).and(bind(&problem, &Sexp));
    let comparison = compare(&mc::Problem::of(&problem), &candidates, &settings(0.02, 1)).unwrap();
    assert!(matches!(comparison.for_error.choice, Choice::WrongReference(_)), "{comparison}");
    assert!(comparison.recommended().is_none());
    assert!(comparison.to_string().contains("converges to something else"), "{comparison}");

    let candidates = Candidates::against(bind(&problem, &failing)).and(bind(&problem, &Sexp));
    let refused = compare(&mc::Problem::of(&problem), &candidates, &settings(0.02, 1)).unwrap_err();
    assert!(matches!(refused, CompareError::Reference { .. }), "{refused}");
}

#[test]
fn an_error_out_of_reach_is_said_to_be() {
    let problem = kubo(OMEGA, SIGMA);
    let candidates = Candidates::against(bind(&problem, &Sexp))
        .and(bind(&problem, &Heun))
        .and(bind(&problem, &EulerMaruyama));
    let settings = CompareSettings { budget_s: 0.5, ..settings(1e-12, 1) };
    let comparison = compare(&mc::Problem::of(&problem), &candidates, &settings).unwrap();
    assert_eq!(comparison.for_error.choice, Choice::NoneReaches);
    assert!(comparison.stopped.is_some_and(|stopped| stopped.budget_s == 0.5));
    let text = comparison.to_string();
    assert!(text.contains("No scheme reaches an error of 1.0e-12 in y(T) within 0.50 s"), "{text}");
}

#[test]
fn bad_requests_are_refused_and_the_value_is_named() {
    let problem = kubo(OMEGA, SIGMA);
    let right = settings(0.01, 1);
    let refused = |settings: &CompareSettings<'_>| {
        let candidates = Candidates::against(bind(&problem, &Sexp)).and(bind(&problem, &Heun));
        compare(&mc::Problem::of(&problem), &candidates, settings).unwrap_err().to_string()
    };
    for error in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
        let message = refused(&CompareSettings { error, ..right });
        let words = format!("the wanted error must be positive and finite, got {error}");
        assert_eq!(message, words);
    }
    let message = refused(&CompareSettings { budget_s: -2.0, ..right });
    assert_eq!(message, "the budget must be positive and finite, got -2");
    let message = refused(&CompareSettings { samples: 31, ..right });
    assert_eq!(message, "the number of paths must be at least 32, got 31");
    let none = Expectations { observables: &[], accuracy: 0.1 };
    let message = refused(&CompareSettings { expectations: Some(none), ..right });
    assert!(message.contains("at least one test function"), "{message}");
    let none = Candidates::against(bind(&problem, &Sexp));
    assert_eq!(
        compare(&mc::Problem::of(&problem), &none, &right).unwrap_err(),
        CompareError::NoScheme
    );
    let long = kubo(OMEGA, SIGMA).until(1e300).unwrap();
    let refused = compare(
        &mc::Problem::of(&long),
        &Candidates::against(bind(&problem, &Sexp)).and(bind(&problem, &Heun)),
        &right,
    )
    .unwrap_err();
    assert_eq!(refused, CompareError::FinalTime { t_end: 1e300 });
}
