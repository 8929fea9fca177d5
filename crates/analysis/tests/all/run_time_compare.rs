//! `compare` on systems from texts: the errors of the compiled systems, with wrong schemes as
//! twins.

use std::sync::Arc;

use analysis::compare::{
    Candidates, Choice, CompareError, CompareSettings, Comparison, ErrorPoint, Expectations, Keeps,
    Outcome, compare,
};
use formula::{Definition, FormulaSystem};
use mc::{Observable, RowFunction, Setup};
use noise::{StreamKey, Truncation};
use real::Row;
use schemes::{EulerMaruyama, Heun, Midpoint, Sexp, SexpLi};
use systems::{Constant, run_time::Problem};

use crate::run_time::{Wrong, body, one_noise, pendulum, texts};

fn key(seed: u64) -> StreamKey {
    StreamKey { seed, experiment: 17 }
}

fn settings<'a>(error: f64) -> CompareSettings<'a> {
    let settings = CompareSettings::new(error, Truncation::new(4).unwrap(), key(1));
    CompareSettings { samples: 128, ..settings }
}

fn near(a: f64, b: f64, part: f64) -> bool {
    a == b || (a - b).abs() <= part * a.abs().max(b.abs())
}

/// Errors of the same schemes with the same steps agree to round-off.
fn check_same(one: &Comparison, other: &Comparison) {
    assert_eq!((one.dimension, one.noises), (other.dimension, other.noises));
    let (a, b) = (&one.for_error, &other.for_error);
    assert!(near(a.reference_error, b.reference_error, 1e-6), "{one}\n{other}");
    assert_eq!(a.candidates.len(), b.candidates.len());
    for (a, b) in a.candidates.iter().zip(&b.candidates) {
        assert_eq!((&a.scheme, a.points.len()), (&b.scheme, b.points.len()), "{one}\n{other}");
        for (a, b) in a.points.iter().zip(&b.points) {
            assert_eq!((a.steps, a.resolved), (b.steps, b.resolved));
            assert!(near(a.error, b.error, 1e-8) && near(a.se, b.se, 1e-6), "{a:?} {b:?}");
        }
    }
    assert_eq!(one.for_expectations.len(), other.for_expectations.len());
    for (a, b) in one.for_expectations.iter().zip(&other.for_expectations) {
        assert!(near(a.mean.unwrap()[0], b.mean.unwrap()[0], 1e-9), "{a:?} {b:?}");
        for (a, b) in a.candidates.iter().zip(&b.candidates) {
            for (a, b) in a.points.iter().zip(&b.points) {
                assert!((a.error - b.error).abs() < 1e-10 && near(a.se, b.se, 1e-6), "{a:?} {b:?}");
            }
        }
    }
}

#[test]
fn errors_on_texts_are_those_on_compiled_systems() {
    let (compiled, texts) = pendulum(0.3);
    let momentum = Observable { name: "p", function: |y: [f64; 2]| y[0] };
    let wanted = Expectations { observables: &[&momentum], accuracy: 0.05 };
    let CompareSettings { samples, truncation, .. } = settings(0.01);
    let one = CompareSettings {
        samples,
        expectations: Some(wanted),
        ..CompareSettings::new(0.01, truncation, key(1))
    };
    let all = Candidates::all(&compiled);
    let one = compare(&mc::Problem::of(&compiled), &all, &one).unwrap();

    let row = RowFunction { name: "p".into(), function: |y: &[Row], p: &mut Row| *p = y[0] };
    let wanted = Expectations { observables: &[&row], accuracy: 0.05 };
    let other = CompareSettings { expectations: Some(wanted), ..settings(0.01) };
    let all = Candidates::at_run_time(&texts).unwrap();
    let other = compare(&mc::Problem::at_run_time(&texts), &all, &other).unwrap();

    let names: Vec<_> = other.for_error.candidates.iter().map(|one| &one.scheme[..]).collect();
    assert_eq!(names, ["sexp", "sexp-li", "midpoint", "heun", "em"]);
    check_same(&one, &other);
    // The recommended scheme reaches the error with its whole interval.
    let Choice::Take { scheme, .. } = other.for_error.choice else { panic!("{other}") };
    let reached = &other.for_error.candidates[scheme].outcome;
    assert!(matches!(reached, Outcome::Reached { .. }), "{other}");
    let taken = &other.for_error.candidates[scheme];
    assert!(taken.points.iter().any(|point| point.resolved && point.hi <= 0.01));
    assert!(other.for_expectations[0].recommended().is_some(), "{other}");
    assert!(other.to_string().contains("texts: D = 2, M = 1"), "{other}");
}

#[test]
fn casimirs_that_were_found_are_measured_on_texts() {
    let (compiled, texts) = body(one_noise(), 0.2);
    let definition = crate::run_time::body_definition(1);
    let system = formula::FormulaSystem::new(&definition, &compiled.y0()).unwrap();
    let found = super::inspect_formulas(&system, &compiled.y0()).unwrap().casimirs.unwrap().found;
    assert_eq!(found.len(), 1);
    let found = found.iter().map(|casimir| casimir.form.clone()).collect();
    let scheme = |scheme| Setup::at_run_time(&texts, scheme).unwrap().scheme;
    let all = Candidates::against(scheme(&Sexp)).and(scheme(&Sexp)).and(scheme(&Heun));
    let all = all.with_casimirs(found);
    let problem = mc::Problem::at_run_time(&texts);
    let comparison = compare(&problem, &all, &settings(0.02)).unwrap();
    let [sexp, heun] = &comparison.for_error.candidates[..] else { panic!("{comparison}") };
    // The law of |y|² holds to round-off for `sexp`, and to the error of the scheme for `heun`.
    assert!(sexp.points.iter().all(|point| point.defect.unwrap() < 1e-12), "{sexp:?}");
    assert!(heun.points.iter().all(|point| point.defect.unwrap() > 1e-6), "{heun:?}");
}

#[test]
fn wrong_schemes_on_texts_are_not_recommended() {
    let (_, texts) = pendulum(0.3);
    let (wrong, li) =
        (Wrong { correction: 0.5, damping: 1.0 }, SexpLi::at_run_time(texts.system()).unwrap());
    let scheme = |scheme| Setup::at_run_time(&texts, scheme).unwrap().scheme;
    let problem = mc::Problem::at_run_time(&texts);
    let of = |all: &Candidates<'_>| compare(&problem, all, &settings(0.02));
    let all = Candidates::against(scheme(&Midpoint)).and(scheme(&wrong)).and(scheme(&li));
    let comparison = of(&all).unwrap();
    let [first, second] = &comparison.for_error.candidates[..] else { panic!("{comparison}") };
    assert!(matches!(first.outcome, Outcome::Inconsistent(_)), "{comparison}");
    assert!(matches!(second.outcome, Outcome::Reached { .. }), "{comparison}");
    assert_eq!(comparison.recommended(), Some("sexp-li"));
    let all = Candidates::against(scheme(&wrong)).and(scheme(&EulerMaruyama));
    let comparison = of(&all).unwrap();
    assert!(matches!(comparison.for_error.choice, Choice::WrongReference(_)), "{comparison}");
    // No scheme, and no error.
    let none = Candidates::against(scheme(&Sexp));
    assert_eq!(of(&none).unwrap_err(), CompareError::NoScheme);
    let all = none.and(scheme(&Heun));
    let refused = compare(&problem, &all, &settings(0.0)).unwrap_err().to_string();
    assert_eq!(refused, "the wanted error must be positive and finite, got 0");
}

/// All schemes on texts without damping, in a budget of seconds.
fn of_texts(
    (definition, y0, t_end): (&Definition, &[f64], f64),
    error: f64,
    budget_s: f64,
) -> Comparison {
    let system = FormulaSystem::new(definition, y0).unwrap();
    let none = Arc::new(Constant::new(0.0).unwrap());
    let problem = Problem::new(Arc::new(system), none, y0.to_vec(), t_end).unwrap();
    let all = Candidates::at_run_time(&problem).unwrap();
    let settings = CompareSettings { budget_s, ..settings(error) };
    let found = compare(&mc::Problem::at_run_time(&problem), &all, &settings).unwrap();
    // A fifth and a second beside the budget.
    assert!(found.wall_s <= 1.2 * budget_s + 1.0, "{} s\n{found}", found.wall_s);
    found
}

#[test]
fn paths_that_part_are_said_to_part() {
    let pendulum = texts("q p", &["1"], "p^2/2-cos(q)", &["0.1*q"]);
    let found = of_texts((&pendulum, &[2.0, 0.0], 500.0), 0.1, 4.0);
    assert_eq!(found.for_error.choice, Choice::NoneReaches);
    assert!(found.sampled.parts(), "{found}");
    let text = found.to_string();
    for words in ["paths part", "casimir expect", "about "] {
        assert!(text.contains(words), "{words} is not in\n{text}");
    }
    assert!(!text.contains("inf") && !text.contains("> 0"), "{text}");
    // The twin: in a short time they do not part.
    let found = of_texts((&pendulum, &[2.0, 0.0], 1.0), 0.01, 20.0);
    assert!(!found.sampled.parts() && found.recommended().is_some(), "{found}");
}

#[test]
fn a_budget_is_kept_on_a_heavy_system() {
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
    let chain = texts(&format!("{}{}", names("q"), names("p")), &rows, &energy, &noises);
    let y0 = [0.5, 0.0, -0.2, 0.1, 0.3, 0.0, 0.0, 0.1, 0.0, 0.2, 0.0, 0.0];
    let found = of_texts((&chain, &y0, 50.0), 1e-6, 2.0);
    assert_eq!(found.for_error.choice, Choice::NoneReaches);
    assert!(found.stopped.is_some(), "{found}");
    let text = found.to_string();
    assert!(text.contains("exceed the budget of 2.00 s") && !text.contains("inf"), "{text}");
}

#[test]
fn what_was_not_reached_is_extrapolated_and_marked() {
    let pendulum = texts("q p", &["1"], "p^2/2-cos(q)", &["0.1*q"]);
    let found = of_texts((&pendulum, &[2.0, 0.0], 1.0), 1e-8, 1.0);
    assert_eq!(found.for_error.choice, Choice::NoneReaches);
    let text = found.to_string();
    // Heun has order one here, so that steps times error stay.
    let heun = found.for_error.candidates.iter().find(|one| one.scheme == "heun").unwrap();
    let Outcome::NotReached { needs, .. } = heun.outcome else { panic!("{text}") };
    let &ErrorPoint { steps, error, resolved, .. } = heun.point().unwrap();
    let predicted = steps as f64 * error / 1e-8;
    assert!(resolved && error > 1e-8, "{text}");
    let needs = needs.expect("extrapolated");
    assert!((0.9 * predicted..5.0 * predicted).contains(&needs), "{needs} {predicted}\n{text}");
    assert!(text.contains("≈") && text.contains("extrapolated, not measured"), "{text}");
}

#[test]
fn a_scheme_that_keeps_more_is_taken_and_the_words_say_so() {
    let (_, damped) = pendulum(0.3);
    let problem = mc::Problem::at_run_time(&damped);
    let scheme = |scheme| Setup::at_run_time(&damped, scheme).unwrap().scheme;
    let all = Candidates::against(scheme(&Sexp)).and(scheme(&Heun)).and(scheme(&Sexp));
    let found = compare(&problem, &all, &settings(0.01)).unwrap();
    let Choice::Take { scheme: taken, cheapest } = found.for_error.choice else {
        panic!("{found}")
    };
    let [heun, sexp] = &found.for_error.candidates[..] else { panic!("{found}") };
    assert!(!heun.keeps.conformal && sexp.keeps.conformal && sexp.keeps > heun.keeps);
    let (_, lo, _) = found.for_error.ratio(1, 0).unwrap();
    let text = found.to_string();
    // The rule, and that what is lost is said either way.
    assert_eq!(taken == 1, cheapest == 1 || lo <= 1.1, "{text}");
    let words =
        if taken == 1 { "keeps the energy of H₀, the exact damping" } else { "Given up: " };
    assert!(text.contains(words), "{text}");
    assert_eq!(Keeps::default(), heun.keeps);
}
