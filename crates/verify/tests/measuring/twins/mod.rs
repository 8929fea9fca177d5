//! Wrong methods that the claims must refute.
//!
//! A measurement that cannot fail says nothing. Each statement has at least one twin here: the same
//! measurement on a method with one deliberate mistake, of the kind that is made in practice. A
//! twin that is not refuted is a failure.

mod conformal;
mod orders;
mod without_iteration;

use schemes::BuiltIn;
use systems::paper::{pendulum, poisson3_strong};
use verify::{
    Conditions, STATEMENTS, ids, reproduce,
    results::{Claim, Verdict},
    statements::{solvability::contraction, truncation::sampled_variance},
    streams,
};

/// A wrong method: the statement that it is a twin of, its mistake in words, and its measurement.
type Twin = (&'static str, &'static str, fn(&Conditions) -> Claim);

/// All of them, by statement.
const TWINS: &[Twin] = &[
    ("truncation-moments", "increments are not truncated", |conditions| {
        sampled_variance(conditions, f64::INFINITY)
    }),
    ("truncation-moments", "the threshold is 2k|log τ| without the square root", |conditions| {
        let tau = 0.25f64;
        sampled_variance(conditions, tau.sqrt() * 2.0 * tau.ln().abs())
    }),
    ("solvability", "increments reach six times the truncation bound", |conditions| {
        contraction(conditions, 0, pendulum().system(), 1.0, 6.0)
    }),
    ("exact-conformal", "a sign in B", conformal::sign_in_exact_flow),
    ("conformal-casimir", "a sign in B", conformal::sign_in_structure),
    (
        "conformal-casimir",
        "the damping of the first half step is used for both halves",
        conformal::damping_of_the_wrong_half,
    ),
    (
        "conformal-casimir",
        "B at the beginning of an implicit step, not in its middle",
        conformal::old_structure,
    ),
    (
        "conformal-casimir",
        "B at the beginning of an implicit step, at steps that shrink",
        conformal::old_structure_at_small_steps,
    ),
    (
        "energy-balance",
        "the gradient at the midpoint instead of its average",
        conformal::midpoint_quadrature,
    ),
    ("moment-bound", "Euler–Maruyama", conformal::unbounded_scheme),
    ("local-exact", "no Lévy areas", without_iteration::local_without_areas),
    ("local-sexp", "no second-order term", without_iteration::local_without_second_order),
    ("strong-half", "the Itô correction is dropped", |conditions| {
        orders::strong_with_correction(conditions, 0.0)
    }),
    ("strong-half", "the Itô correction is doubled", |conditions| {
        orders::strong_with_correction(conditions, 2.0)
    }),
    ("strong-half", "two noises fed by one stream", orders::shared_stream),
    (
        "strong-half",
        "fresh coarse increments instead of sums of the fine ones",
        orders::fresh_increments,
    ),
    ("strong-one", "explicit noise: Euler–Maruyama", orders::explicit),
    (
        "strong-one",
        "truncation with a bound of half a standard deviation",
        orders::truncated_too_early,
    ),
    ("strong-one-levy", "Lévy areas of the wrong sign", |conditions| {
        orders::scaled_areas(conditions, -1.0)
    }),
    ("strong-one-levy", "Lévy areas drawn afresh on each coarse grid", orders::fresh_areas),
    ("strong-one-levy", "no Lévy areas", |conditions| orders::scaled_areas(conditions, 0.0)),
    ("weak-one", "the Itô correction is dropped", |conditions| {
        orders::weak_with_correction(conditions, 0.0)
    }),
    ("weak-one", "the Itô correction is doubled", |conditions| {
        orders::weak_with_correction(conditions, 2.0)
    }),
    ("conformal-casimir", "sexp-li: a sign in Cayley's map", without_iteration::sign_in_cayley),
    (
        "conformal-casimir",
        "sexp-li: the damping of the first half step for both halves",
        |conditions| without_iteration::first_half_twice(conditions, BuiltIn::SexpLi),
    ),
    (
        "conformal-casimir",
        "split: the damping of the first half step for both halves",
        |conditions| without_iteration::first_half_twice(conditions, BuiltIn::Split),
    ),
    ("strong-one", "sexp-li: v from the beginning", without_iteration::strong_shifted),
    ("strong-one", "split: flows in a row, pendulum", without_iteration::pendulum_in_a_row),
    ("strong-one", "split: flows in a row, Poisson system", without_iteration::poisson_in_a_row),
    ("local-sexp-li", "v from the beginning", |conditions| {
        without_iteration::local_shifted(conditions, 0.0)
    }),
    ("local-sexp-li", "v from the end", |conditions| {
        without_iteration::local_shifted(conditions, 1.0)
    }),
    ("local-sexp-li", "v from the wrong side of the beginning", |conditions| {
        without_iteration::local_shifted(conditions, -0.5)
    }),
    ("local-split", "flows in a row", without_iteration::local_in_a_row),
    ("any-increment", "sexp-li: increments are clipped", without_iteration::clipped_body),
    ("any-increment", "split: increments are clipped", without_iteration::clipped_light),
    (
        "any-increment",
        "sexp-li: a sign in Cayley's map",
        without_iteration::sign_in_cayley_with_large_noise,
    ),
    ("no-noise", "split: flows in a row, pendulum", |conditions| {
        without_iteration::order_in_a_row(conditions, &pendulum())
    }),
    ("no-noise", "split: flows in a row, Poisson system", |conditions| {
        without_iteration::order_in_a_row(conditions, &poisson3_strong())
    }),
    ("no-noise", "sexp-li: all damping at first", without_iteration::order_damped_before),
    ("no-noise", "split: all damping at last", without_iteration::order_damped_after),
];

#[test]
fn every_twin_is_refuted() {
    for (experiment, (id, mistake, measure)) in (streams::TWINS..).zip(TWINS) {
        let claim = measure(&Conditions { seed: 1, quick: true, experiment, id: "" });
        assert_eq!(claim.verdict, Verdict::Refuted, "{id}, {mistake}: {}", claim.evidence);
    }
}

#[test]
fn the_right_methods_are_not_refuted() {
    for claim in reproduce(1, true, &ids(STATEMENTS).collect::<Vec<_>>()).claims {
        assert_ne!(claim.outcome(), "refuted", "{}: {}", claim.id, claim.evidence);
    }
}

#[test]
fn every_statement_has_a_twin() {
    let of_panels =
        ["conformal-casimir", "energy-balance", "strong-half", "strong-one", "weak-one"];
    for id in ids(STATEMENTS).chain(of_panels) {
        assert!(TWINS.iter().any(|twin| twin.0 == id), "{id} has no twin");
    }
}
