//! Wrong methods that the claims must refute.
//!
//! A measurement that cannot fail says nothing. Each statement has at least one twin here: the same
//! measurement on a method with one deliberate mistake, of the kind that is made in practice. A
//! twin that is not refuted is a failure.

mod conformal;
mod orders;
mod without_iteration;

use mc::Setup;
use noise::StepNoise;
use schemes::{BuiltIn, Composed, EulerMaruyama, Sexp, Step};
use systems::paper::{
    lotka_volterra_2_2, maxwell_bloch, pendulum, poisson3_strong, rigid_body_energy,
    rigid_body_one_noise, rigid_body_three_noises,
};
use verify::{
    Conditions, STATEMENTS, ids, reproduce,
    results::{Claim, Verdict},
    statements::{
        exact_conformal, moment_bound,
        solvability::contraction,
        truncation::sampled_variance,
        without_iteration::{keeps_casimir, order_two},
    },
    streams,
};

use conformal::{FirstHalfTwice, OldStructure, casimir, obeys_law, wrong};
use orders::{Miscorrected, half, strong};
use without_iteration::{InARow, Shifted, Sign, local};

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
    ("exact-conformal", "a sign in B", |conditions| {
        let problem = wrong::<_, _, 3>(rigid_body_three_noises(1.0), -1.0);
        exact_conformal::law(conditions, 0, &problem).swap_remove(0)
    }),
    ("conformal-casimir", "a sign in B", |conditions| {
        let problem = wrong::<_, _, 3>(rigid_body_three_noises(10.0), -1.0);
        obeys_law(conditions, &Setup::of::<_, _, 3, 3>(&problem, &Sexp))
    }),
    (
        "conformal-casimir",
        "the damping of the first half step is used for both halves",
        |conditions| casimir(conditions, &FirstHalfTwice),
    ),
    (
        "conformal-casimir",
        "B at the beginning of an implicit step, not in its middle",
        |conditions| casimir(conditions, &OldStructure),
    ),
    (
        "conformal-casimir",
        "B at the beginning of an implicit step, at steps that shrink",
        conformal::old_structure_at_small_steps,
    ),
    ("energy-balance", "the gradient at the midpoint instead of its average", |conditions| {
        let problem = wrong::<_, _, 1>(lotka_volterra_2_2(10.0), 1.0);
        obeys_law(conditions, &Setup::of::<_, _, 3, 1>(&problem, &Sexp))
    }),
    ("moment-bound", "Euler–Maruyama", |conditions| {
        let problem = moment_bound::undamped();
        let setup = Setup::of::<_, _, 3, 3>(&problem, &EulerMaruyama);
        moment_bound::bound(conditions, 0, &setup, 0, 0.5)
    }),
    ("local-exact", "no Lévy areas", without_iteration::local_without_areas),
    ("local-sexp", "no second-order term", without_iteration::local_without_second_order),
    ("strong-half", "the Itô correction is dropped", |conditions| {
        half(conditions, &Miscorrected { factor: 0.0 }, |_, _| ())
    }),
    ("strong-half", "the Itô correction is doubled", |conditions| {
        half(conditions, &Miscorrected { factor: 2.0 }, |_, _| ())
    }),
    ("strong-half", "two noises fed by one stream", |conditions| {
        half(conditions, &Sexp, |_, noise| noise.increments[1] = noise.increments[0])
    }),
    // The increments of the neighbouring path: the right law, drawn afresh.
    ("strong-half", "fresh coarse increments instead of sums of the fine ones", |conditions| {
        let fresh = |_: &mut Step, noise: &mut StepNoise| {
            noise.increments.iter_mut().for_each(|row| row.rotate_left(1));
        };
        half(conditions, &Sexp, fresh)
    }),
    ("strong-one", "explicit noise: Euler–Maruyama", |conditions| {
        strong::<_, _, 3, 1>(conditions, &rigid_body_one_noise(), &EulerMaruyama)
    }),
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
    ("weak-one", "the Itô correction is dropped", |conditions| orders::weak(conditions, 0.0)),
    ("weak-one", "the Itô correction is doubled", |conditions| orders::weak(conditions, 2.0)),
    ("conformal-casimir", "sexp-li: a sign in Cayley's map", |conditions| {
        casimir(conditions, &Sign)
    }),
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
    // About a fixed axis, as of a single noise of the other bodies, v does not change.
    ("strong-one", "sexp-li: v from the beginning", |conditions| {
        strong(conditions, &rigid_body_energy(1.0), &Shifted { shift: 0.0 })
    }),
    ("strong-one", "split: flows in a row, pendulum", |conditions| {
        strong(conditions, &pendulum(), &Composed(InARow))
    }),
    ("strong-one", "split: flows in a row, Poisson system", |conditions| {
        strong(conditions, &poisson3_strong(), &Composed(InARow))
    }),
    ("local-sexp-li", "v from the beginning", |conditions| {
        local(conditions, &Shifted { shift: 0.0 })
    }),
    ("local-sexp-li", "v from the end", |conditions| local(conditions, &Shifted { shift: 1.0 })),
    ("local-sexp-li", "v from the wrong side of the beginning", |conditions| {
        local(conditions, &Shifted { shift: -0.5 })
    }),
    ("local-split", "flows in a row", |conditions| local(conditions, &Composed(InARow))),
    ("any-increment", "sexp-li: increments are clipped", |conditions| {
        without_iteration::clipped(conditions, &rigid_body_three_noises(1.0), BuiltIn::SexpLi)
    }),
    ("any-increment", "split: increments are clipped", |conditions| {
        without_iteration::clipped(conditions, &maxwell_bloch(1.0), BuiltIn::Split)
    }),
    ("any-increment", "sexp-li: a sign in Cayley's map", |conditions| {
        let problem = rigid_body_three_noises(1.0);
        keeps_casimir(conditions, 0, Setup::of::<_, _, 3, 3>(&problem, &Sign))
    }),
    ("no-noise", "split: flows in a row, pendulum", |conditions| {
        order_two(conditions, 0, Setup::of(&pendulum(), &Composed(InARow)))
    }),
    ("no-noise", "split: flows in a row, Poisson system", |conditions| {
        order_two(conditions, 0, Setup::of(&poisson3_strong(), &Composed(InARow)))
    }),
    ("no-noise", "sexp-li: all damping at first", without_iteration::order_damped_before),
    ("no-noise", "split: all damping at last", without_iteration::order_damped_after),
];

#[test]
fn every_twin_is_refuted() {
    for (experiment, &(id, mistake, measure)) in (streams::TWINS..).zip(TWINS) {
        let claim = measure(&Conditions { seed: 1, quick: true, experiment, id });
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
