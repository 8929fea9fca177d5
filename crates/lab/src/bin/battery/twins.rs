//! Wrong methods that the claims must refute.
//!
//! A measurement that cannot fail says nothing. Each statement has at least one twin here: the same
//! measurement on a method with one deliberate mistake, of the kind that is made in practice. A
//! twin that is not refuted is a failure of the battery.

mod conformal;
mod levy;
mod local;
mod orders;
mod systems;

use ::systems::Pendulum;
use ::systems::paper::valid;
use verify::results::Claim;
use verify::{Progress, Settings};

use crate::experiment::{Context, Twin};
use crate::statements::{solvability, truncation};

/// All of them, by statement.
pub const TWINS: &[Twin] = &[
    Twin {
        claim: "truncation-moments",
        mistake: "increments are not truncated",
        measure: |context| truncation::sampled_variance(context, f64::INFINITY),
    },
    Twin {
        claim: "truncation-moments",
        mistake: "the threshold is 2k|log τ| without the square root",
        measure: |context| {
            let tau = 0.25f64;
            truncation::sampled_variance(context, tau.sqrt() * 2.0 * tau.ln().abs())
        },
    },
    Twin {
        claim: "solvability",
        mistake: "increments reach six times the truncation bound",
        measure: |context| {
            solvability::contraction::<_, 2>(context, 0, &valid(Pendulum::new(1.0)), 1.0, 6.0)
        },
    },
    Twin {
        claim: "exact-conformal",
        mistake: "a sign in B",
        measure: conformal::sign_in_exact_flow,
    },
    Twin {
        claim: "conformal-casimir",
        mistake: "a sign in B",
        measure: conformal::sign_in_structure,
    },
    Twin {
        claim: "conformal-casimir",
        mistake: "the damping of the first half step is used for both halves",
        measure: conformal::damping_of_the_wrong_half,
    },
    Twin {
        claim: "conformal-casimir",
        mistake: "explicit noise in an implicit scheme",
        measure: conformal::explicit_noise,
    },
    Twin {
        claim: "conformal-casimir",
        mistake: "explicit noise in an implicit scheme, at steps that shrink",
        measure: conformal::explicit_noise_at_small_steps,
    },
    Twin {
        claim: "energy-balance",
        mistake: "the gradient at the midpoint instead of its average",
        measure: conformal::midpoint_quadrature,
    },
    Twin {
        claim: "moment-bound", mistake: "Euler–Maruyama", measure: conformal::unbounded_scheme
    },
    Twin { claim: "local-exact", mistake: "no Lévy areas", measure: local::without_areas },
    Twin {
        claim: "local-sexp",
        mistake: "no second-order term",
        measure: local::without_second_order,
    },
    Twin {
        claim: "strong-half",
        mistake: "the Itô correction is dropped",
        measure: orders::correction_dropped,
    },
    Twin {
        claim: "strong-half",
        mistake: "the Itô correction is doubled",
        measure: orders::correction_doubled,
    },
    Twin {
        claim: "strong-half",
        mistake: "two noises fed by one stream",
        measure: orders::shared_stream,
    },
    Twin {
        claim: "strong-half",
        mistake: "fresh coarse increments instead of sums of the fine ones",
        measure: orders::fresh_increments,
    },
    Twin {
        claim: "strong-one",
        mistake: "explicit noise: Euler–Maruyama",
        measure: orders::explicit,
    },
    Twin {
        claim: "strong-one",
        mistake: "truncation with a bound of half a standard deviation",
        measure: orders::truncated_too_early,
    },
    Twin {
        claim: "strong-one-levy",
        mistake: "Lévy areas of the wrong sign",
        measure: levy::wrong_sign,
    },
    Twin {
        claim: "strong-one-levy",
        mistake: "Lévy areas drawn afresh on each coarse grid",
        measure: levy::fresh_areas,
    },
    Twin { claim: "strong-one-levy", mistake: "no Lévy areas", measure: levy::without_areas },
    Twin {
        claim: "weak-one",
        mistake: "the Itô correction is dropped",
        measure: orders::weak_correction_dropped,
    },
    Twin {
        claim: "weak-one",
        mistake: "the Itô correction is doubled",
        measure: orders::weak_correction_doubled,
    },
];

/// First experiment number of the twins.
const TWIN_NUMBERS: u64 = 3000;

/// Measures every twin; the claims come in the order of [`TWINS`].
pub fn measure_twins(settings: Settings, progress: &dyn Progress) -> Vec<Claim> {
    (TWIN_NUMBERS..)
        .zip(TWINS)
        .map(|(experiment, twin)| {
            (twin.measure)(&Context { settings, experiment, wanted: &[], progress })
        })
        .collect()
}
