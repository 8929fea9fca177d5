//! `compare` on Kubo's oscillator, whose strong errors are known, and on others, with wrong schemes
//! as twins.

use analysis::compare::{
    Candidates, Choice, CompareSettings, Comparison, ErrorPoint, Outcome, compare,
};
use formula::Definition;
use kernels::Tuned;
use mc::{RunError, Setup};
use noise::{StreamKey, Truncation};
use schemes::{BuiltIn, EulerMaruyama, Heun, Midpoint, Sexp, SexpLi, run_time::Scheme};
use systems::{paper::rigid_body_three_noises, run_time::Problem};

use crate::{SPIN, kubo, problem, pushed, statistical::orders::Wrong, texts};

const OMEGA: f64 = 1.0;
const SIGMA: f64 = 0.7;

fn settings(error: f64, seed: u64) -> CompareSettings {
    let key = StreamKey { seed, experiment: 11 };
    CompareSettings::new(error, Truncation::new(4).unwrap(), key)
}

/// These schemes against a reference, with its comparison.
fn compared(
    problem: &Problem,
    reference: &dyn Scheme,
    schemes: &[&dyn Scheme],
    settings: &CompareSettings,
) -> Result<Comparison, RunError> {
    let scheme = |scheme| Setup::at_run_time(problem, scheme).unwrap().scheme;
    let none = Candidates::against(scheme(reference));
    let all = schemes.iter().fold(none, |all, one| all.and(scheme(*one)));
    compare(&mc::Problem::at_run_time(problem), &all, settings, &|_, _| ())
}

fn names(comparison: &Comparison) -> Vec<&str> {
    comparison.candidates.iter().map(|one| &one.scheme[..]).collect()
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
    let schemes: [&dyn Scheme; 4] = [&Sexp, &Midpoint, &Heun, &EulerMaruyama];
    let (mut points, mut misses) = (0, Vec::new());
    for seed in 1..=6 {
        let comparison = compared(&problem, &Sexp, &schemes, &settings(0.02, seed)).unwrap();
        assert!(comparison.recommended().is_some(), "{comparison}");
        for (one, a) in comparison.candidates.iter().zip([cayley, cayley, heun, em]) {
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
fn all_schemes_are_compared_and_the_choice_is_in_words() {
    let problem = kubo(OMEGA, SIGMA);
    let all = at_run_time(&problem);
    let of = |seed| {
        compare(&mc::Problem::at_run_time(&problem), &all, &settings(0.02, seed), &|_, _| ())
            .unwrap()
    };
    let comparison = of(1);
    // One noise commutes, and B is constant. All of it is one exact flow.
    let all =
        ["sexp", "sexp-li", "split", "split-h", "sexp-h", "nv", "baoab", "midpoint", "heun", "em"];
    assert_eq!(names(&comparison), all);
    let text = comparison.to_string();
    for words in ["in y(T)", "scheme", "Take ", "texts: D = 2, M = 1"] {
        assert!(text.contains(words), "{words} is not in\n{text}");
    }
    // Every candidate is priced against the cheapest, and the one taken keeps no less.
    let Choice::Take { scheme, cheapest } = comparison.choice else { panic!("{text}") };
    let (taken, least) = (&comparison.candidates[scheme], &comparison.candidates[cheapest]);
    assert!(taken.keeps >= least.keeps, "{text}");
    assert!(matches!(taken.outcome, Outcome::Reached { .. }), "{text}");
    assert!(taken.points.iter().any(|point| point.hi <= 0.02), "{text}");
    let (ratio, lo, _) = taken.ratio(least).unwrap();
    assert!(ratio >= 1.0 && lo <= 1.1, "{text}");
    let (ratio, lo, _) = comparison.candidates[0].ratio(least).unwrap();
    assert!(ratio >= 1.0 && lo <= ratio, "{text}");
    // Errors are the same bits, and follow the seed.
    let errors = |comparison: &Comparison| -> Vec<ErrorPoint> {
        let points = comparison.candidates.iter().flat_map(|one| one.points.clone());
        points.map(|point| ErrorPoint { time: None, ..point }).collect()
    };
    assert_eq!(errors(&comparison), errors(&of(1)));
    assert_ne!(errors(&comparison), errors(&of(2)));
    let read: Comparison =
        serde_json::from_str(&serde_json::to_string(&comparison).unwrap()).unwrap();
    assert_eq!(read, comparison);
}

#[test]
fn flows_of_parts_and_their_casimirs_are_compared() {
    let problem = rigid_body_three_noises(1.0);
    let settings = CompareSettings { samples: 128, ..settings(0.1, 1) };
    let all = Candidates::compiled(&problem, Tuned::scheme);
    let found = compare(&mc::Problem::of(&problem), &all, &settings, &|_, _| ()).unwrap();
    let expected =
        ["sexp", "sexp-levy", "sexp-li", "sexp-li-levy", "split", "nv", "midpoint", "heun", "em"];
    assert_eq!(names(&found), expected);
    assert!(found.to_string().contains("half of the error is asked"), "{found}");
    for one in &found.candidates {
        if one.scheme.ends_with("-levy") && matches!(one.outcome, Outcome::Reached { .. }) {
            assert!(one.point().unwrap().error <= 0.05, "{found}");
        }
        for time in one.points.iter().map(|point| point.time.unwrap()) {
            assert!(0.0 < time.best && time.best <= time.median, "{time:?}");
            assert!(time.median <= time.worst, "{time:?}");
        }
        let keeps = !["midpoint", "heun", "em"].contains(&&one.scheme[..]);
        assert_eq!(one.keeps.casimirs, keeps, "{found}");
    }
}

#[test]
fn casimirs_that_were_found_are_measured() {
    let y0 = [0.5, 0.6, 0.62];
    let definition = texts("x y z", &SPIN, "x^2/4 + y^2/2 + z^2", &["x^2/2"]);
    let found = crate::inspect_around(&crate::system(&definition, &y0), &y0).unwrap();
    let found = found.casimirs.unwrap().found;
    assert_eq!(found.len(), 1);
    let problem = problem(&definition, 0.2, &y0, 1.0);
    let scheme = |scheme: &'static dyn Scheme| Setup::at_run_time(&problem, scheme).unwrap().scheme;
    let all = Candidates::against(scheme(&Sexp)).and(scheme(&Sexp)).and(scheme(&Heun));
    let laws = found.iter().map(|casimir| casimir.form.law("C".into())).collect();
    let lawful = mc::Problem { laws, ..mc::Problem::at_run_time(&problem) };
    let comparison = compare(&lawful, &all, &settings(0.02, 1), &|_, _| ());
    let comparison = comparison.unwrap();
    let [sexp, heun] = &comparison.candidates[..] else { panic!("{comparison}") };
    // The law of |y|² holds to round-off for `sexp`, and to the error of the scheme for `heun`.
    assert!(sexp.points.iter().all(|point| point.defect.unwrap() < 1e-12), "{sexp:?}");
    assert!(heun.points.iter().all(|point| point.defect.unwrap() > 1e-6), "{heun:?}");
}

#[test]
fn a_wrong_scheme_is_not_recommended_and_a_wrong_reference_is_named() {
    let problem = kubo(OMEGA, SIGMA);
    // Half of the Itô correction: it converges to something else.
    let wrong = Wrong { correction: 0.5, damping: 1.0 };
    let failing = Wrong { correction: f64::NAN, damping: 1.0 };
    let li = SexpLi::at_run_time(problem.system()).unwrap();
    let settings = settings(0.02, 1);
    let comparison = compared(&problem, &Midpoint, &[&wrong, &failing, &li], &settings).unwrap();
    let [first, second, third] = &comparison.candidates[..] else { panic!() };
    assert!(matches!(first.outcome, Outcome::Inconsistent(_)), "{comparison}");
    assert!(matches!(second.outcome, Outcome::Fails(_)), "{comparison}");
    assert!(matches!(third.outcome, Outcome::Reached { .. }), "{comparison}");
    assert_eq!(comparison.recommended(), Some("sexp-li"));
    // No path of the others is lost to the scheme that fails.
    assert_eq!(comparison.sampled.failed, 0);

    let comparison = compared(&problem, &wrong, &[&Sexp], &settings).unwrap();
    assert!(matches!(comparison.choice, Choice::WrongReference(_)), "{comparison}");
    assert!(comparison.recommended().is_none());
    assert!(comparison.to_string().contains("converges to something else"), "{comparison}");
    let refused = compared(&problem, &failing, &[&Sexp], &settings).unwrap_err();
    assert!(refused.to_string().contains("fails on pilot paths"), "{refused}");
}

fn at_run_time(problem: &Problem) -> Candidates<'_> {
    let bind =
        |id: BuiltIn| Ok(Setup::at_run_time(problem, id.at_run_time(problem.system())?)?.scheme);
    Candidates::built_in(bind).unwrap()
}

/// All schemes, in a budget of seconds.
fn in_budget(problem: &Problem, error: f64, budget_s: f64) -> Comparison {
    let all = at_run_time(problem);
    let settings = CompareSettings { budget_s, samples: 128, ..settings(error, 1) };
    let found = compare(&mc::Problem::at_run_time(problem), &all, &settings, &|_, _| ()).unwrap();
    // A fifth and a second beside the budget.
    assert!(found.wall_s <= 1.2 * budget_s + 1.0, "{} s\n{found}", found.wall_s);
    found
}

#[test]
fn paths_that_part_are_said_to_part() {
    let found = in_budget(&pushed(500.0), 0.1, 2.0);
    assert_eq!(found.choice, Choice::NoneReaches);
    assert!(found.sampled.parts(), "{found}");
    let text = found.to_string();
    for words in ["paths part", "casimir expect", "about "] {
        assert!(text.contains(words), "{words} is not in\n{text}");
    }
    assert!(!text.contains("inf") && !text.contains("> 0"), "{text}");
    // The twin: in a short time they do not part.
    let found = in_budget(&pushed(1.0), 0.01, 20.0);
    assert!(!found.sampled.parts() && found.recommended().is_some(), "{found}");
}

/// Six oscillators in a ring, each with a noise.
fn ring() -> Definition {
    let (n, names) = (6, |name: &str| (0..6).map(|i| format!("{name}{i} ")).collect::<String>());
    let row =
        |i: usize| (i + 1..2 * n).map(|j| if j == i + n { "1 " } else { "0 " }).collect::<String>();
    let rows: Vec<String> = (0..2 * n - 1).map(row).collect();
    let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
    let energy = (0..n).fold(String::from("0"), |sum, i| {
        format!("{sum}+p{i}^2/2+q{i}^2/2+(q{i}-q{})^2/2+0.1*(q{i}-q0)^4", (i + 1) % n)
    });
    let noises: Vec<String> = (0..n).map(|i| format!("0.1*q{i}")).collect();
    let noises: Vec<&str> = noises.iter().map(String::as_str).collect();
    texts(&format!("{}{}", names("q"), names("p")), &rows, &energy, &noises)
}

#[test]
fn a_budget_is_kept_on_a_heavy_system() {
    let y0 = [0.5, 0.0, -0.2, 0.1, 0.3, 0.0, 0.0, 0.1, 0.0, 0.2, 0.0, 0.0];
    let found = in_budget(&problem(&ring(), 0.0, &y0, 50.0), 1e-6, 1.0);
    assert_eq!(found.choice, Choice::NoneReaches);
    assert!(found.stopped.is_some_and(|stopped| stopped.budget_s == 1.0), "{found}");
    let text = found.to_string();
    assert!(text.contains("steps within 1.00 s") && !text.contains("inf"), "{text}");
    assert!(text.contains("No scheme reaches an error of 1.0e-6 in y(T) within 1.00 s"), "{text}");
}

#[test]
fn what_was_not_reached_is_extrapolated_and_marked() {
    let found = in_budget(&pushed(1.0), 1e-8, 1.0);
    assert_eq!(found.choice, Choice::NoneReaches);
    let text = found.to_string();
    // Heun has order one here, so that steps times error stay.
    let heun = found.candidates.iter().find(|one| one.scheme == "heun").unwrap();
    let Outcome::NotReached { needs } = heun.outcome else { panic!("{text}") };
    let &ErrorPoint { steps, error, resolved, .. } = heun.point().unwrap();
    let predicted = steps as f64 * error / 1e-8;
    assert!(resolved && error > 1e-8, "{text}");
    let needs = needs.expect("extrapolated");
    assert!((0.9 * predicted..5.0 * predicted).contains(&needs), "{needs} {predicted}\n{text}");
    assert!(text.contains("≈") && text.contains("extrapolated, not measured"), "{text}");
}

#[test]
fn a_scheme_that_keeps_more_is_taken_and_the_words_say_so() {
    let pendulum = texts("p q", &["-1"], "p^2/2 - cos(q)", &["0.5*(p^2/2 - cos(q))"]);
    let pendulum = problem(&pendulum, 0.3, &[0.2, 1.0], 1.0);
    let found = compared(&pendulum, &Sexp, &[&Heun, &Sexp], &settings(0.01, 1)).unwrap();
    let Choice::Take { scheme: taken, cheapest } = found.choice else { panic!("{found}") };
    let [heun, sexp] = &found.candidates[..] else { panic!("{found}") };
    assert!(!heun.keeps.conformal && sexp.keeps.conformal && sexp.keeps > heun.keeps);
    let (_, lo, _) = sexp.ratio(heun).unwrap();
    let text = found.to_string();
    // The rule, and that what is lost is said either way.
    assert_eq!(taken == 1, cheapest == 1 || lo <= 1.1, "{text}");
    let words =
        if taken == 1 { "keeps the energy of H₀, the exact damping" } else { "Given up: " };
    assert!(text.contains(words), "{text}");
}

#[test]
fn bad_requests_are_refused_and_the_value_is_named() {
    let (problem, right) = (kubo(OMEGA, SIGMA), settings(0.01, 1));
    let refused = |settings: CompareSettings| {
        compared(&problem, &Sexp, &[&Heun], &settings).unwrap_err().to_string()
    };
    for error in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
        let words = format!("the wanted error must be positive and finite, got {error}");
        assert_eq!(refused(CompareSettings { error, ..right.clone() }), words);
    }
    let message = refused(CompareSettings { budget_s: -2.0, ..right.clone() });
    assert_eq!(message, "the budget must be positive and finite, got -2");
    let message = refused(CompareSettings { samples: 31, ..right.clone() });
    assert_eq!(message, "the number of paths must be at least 32, got 31");
    let none = compared(&problem, &Sexp, &[], &right).unwrap_err();
    assert_eq!(none.to_string(), "the number of schemes must be at least one, got 0");
    let refused = compared(&pushed(1e300), &Sexp, &[&Heun], &right).unwrap_err().to_string();
    assert!(refused.starts_with("the final time must be below 1e9"), "{refused}");
}
