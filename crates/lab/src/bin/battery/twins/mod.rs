//! Wrong methods that the claims must refute.
//!
//! A measurement that cannot fail says nothing. Each statement has at least one twin here: the same
//! measurement on a method with one deliberate mistake, of the kind that is made in practice. A
//! twin that is not refuted is a failure of the battery.

mod conformal;
mod local;
mod orders;
mod wrong_noise;
mod wrong_systems;

use lab::statements::{solvability::contraction, truncation::sampled_variance};
use lab::{Conditions, streams};
use systems::paper::pendulum;
use verify::results::Claim;
use verify::{Progress, Settings};

/// A wrong method with its measurement.
pub type Twin = verify::Twin<fn(&Conditions<'_>) -> Claim>;

/// All of them, by statement.
pub const TWINS: &[Twin] = &[
    Twin {
        claim: "truncation-moments",
        mistake: "increments are not truncated",
        measure: |conditions| sampled_variance(conditions, f64::INFINITY),
    },
    Twin {
        claim: "truncation-moments",
        mistake: "the threshold is 2k|log τ| without the square root",
        measure: |conditions| {
            let tau = 0.25f64;
            sampled_variance(conditions, tau.sqrt() * 2.0 * tau.ln().abs())
        },
    },
    Twin {
        claim: "solvability",
        mistake: "increments reach six times the truncation bound",
        measure: |conditions| contraction(conditions, 0, pendulum().system(), 1.0, 6.0),
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
        mistake: "B at the beginning of an implicit step, not in its middle",
        measure: conformal::old_structure,
    },
    Twin {
        claim: "conformal-casimir",
        mistake: "B at the beginning of an implicit step, at steps that shrink",
        measure: conformal::old_structure_at_small_steps,
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
        measure: |conditions| orders::strong_with_correction(conditions, 0.0),
    },
    Twin {
        claim: "strong-half",
        mistake: "the Itô correction is doubled",
        measure: |conditions| orders::strong_with_correction(conditions, 2.0),
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
        measure: orders::areas_of_the_wrong_sign,
    },
    Twin {
        claim: "strong-one-levy",
        mistake: "Lévy areas drawn afresh on each coarse grid",
        measure: orders::fresh_areas,
    },
    Twin { claim: "strong-one-levy", mistake: "no Lévy areas", measure: orders::without_areas },
    Twin {
        claim: "weak-one",
        mistake: "the Itô correction is dropped",
        measure: |conditions| orders::weak_with_correction(conditions, 0.0),
    },
    Twin {
        claim: "weak-one",
        mistake: "the Itô correction is doubled",
        measure: |conditions| orders::weak_with_correction(conditions, 2.0),
    },
];

/// Measures every twin; the claims come in the order of [`TWINS`].
pub fn measure_twins(settings: Settings, progress: &dyn Progress) -> Vec<Claim> {
    let numbered = (streams::TWINS..).zip(TWINS);
    let measure = |(experiment, twin): (u64, &Twin)| {
        (twin.measure)(&Conditions { settings, experiment, wanted: &[], progress })
    };
    numbered.map(measure).collect()
}

#[cfg(test)]
mod tests {
    use lab::{STATEMENTS, ids, reproduce};
    use verify::results::Verdict;
    use verify::{Mode, Silent};

    use super::*;

    const SEEDS: [u64; 3] = [1, 2, 3];

    #[test]
    fn every_twin_is_refuted() {
        for seed in SEEDS {
            let settings = Settings { seed, mode: Mode::Quick };
            for (twin, claim) in TWINS.iter().zip(measure_twins(settings, &Silent)) {
                let Twin { claim: id, mistake, .. } = twin;
                let evidence = &claim.evidence;
                assert_eq!(claim.verdict, Verdict::Refuted, "{seed}: {id}, {mistake}: {evidence}");
            }
        }
    }

    #[test]
    fn the_right_methods_are_not_refuted() {
        let only: Vec<String> = ids(STATEMENTS).into_iter().map(str::to_owned).collect();
        for seed in SEEDS {
            let settings = Settings { seed, mode: Mode::Quick };
            for claim in reproduce(settings, &only, &Silent).unwrap().claims {
                assert!(!claim.is_refuted(), "seed {seed}: {}: {}", claim.id, claim.evidence);
            }
        }
    }

    #[test]
    fn every_statement_has_a_twin() {
        let of_panels =
            ["conformal-casimir", "energy-balance", "strong-half", "strong-one", "weak-one"];
        for id in ids(STATEMENTS).into_iter().chain(of_panels) {
            assert!(TWINS.iter().any(|twin| twin.claim == id), "{id} has no twin");
        }
    }
}
