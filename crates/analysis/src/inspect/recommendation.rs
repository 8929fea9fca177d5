//! Which scheme to take for a system, for what.

use serde::Serialize;
use systems::Linearity;

use super::{finding::Status, report::Inspection};
use crate::facts::Kept;

/// A scheme to take.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Recommendation {
    /// What for: `paths`; `short-paths`, too short for the energy to drift; `expectations`; or
    /// `large-noise`, steps with large increments.
    pub purpose: &'static str,
    /// Its identifier.
    pub scheme: &'static str,
    /// Why.
    pub because: String,
}

/// The schemes to take for a system with damping or without, that for paths first.
pub fn recommendations(report: &Inspection, damped: bool) -> Vec<Recommendation> {
    let Inspection { structure, hamiltonians, casimirs, noise, schemes, .. } = report;
    let sound = structure.sound() != Status::Fails;
    let claims = report.invariants.iter().any(|i| i.claimed_casimir && i.status().holds());
    let found = casimirs.as_ref().map_or(claims, |casimirs| !casimirs.found.is_empty());
    let casimirs_kept = sound && found;
    let energy = sound
        && hamiltonians.proportional.holds()
        && (hamiltonians.shapes[0].degree.is_some() || !damped);
    let linear = schemes.sexp_li_refused.is_none();
    let areas = !noise.commute.holds() && schemes.draws_areas;
    let mut found = Vec::new();
    let mut take = |purpose, scheme, because: &str| {
        found.push(Recommendation { purpose, scheme, because: because.into() });
    };
    let (scheme, mut because) = Kept { casimirs: casimirs_kept, energy, areas }.scheme();
    if !hamiltonians.discrete_gradient.holds() {
        because += "; the energy up to the error of ∇̄h";
    }
    if casimirs.as_ref().is_some_and(|casimirs| !casimirs.logarithmic.is_empty()) {
        because += "; split alone keeps the Casimir with logarithms";
    }
    take("paths", scheme, &because);
    let implicit = linear && schemes.structure == Linearity::Affine;
    let without_iteration = if areas { "sexp-li-levy" } else { "sexp-li" };
    if casimirs_kept && implicit {
        let because = "it keeps the Casimirs at about the price of heun, and the energy drifts";
        take("short-paths", without_iteration, because);
    }
    let random = !noise.silent.holds();
    if random && linear {
        let because = "mc::expect extrapolates weak order 1; with flows of parts take nv";
        // Without iteration a step is explicit where B is constant.
        let scheme = if implicit { "sexp-li" } else { "sexp" };
        take("expectations", scheme, because);
    } else if random && areas {
        take("expectations", "sexp", "weak order 1 takes no areas");
    }
    // With a constant B the scheme is explicit, and large steps grow.
    if sound && implicit && !schemes.truncates && random {
        let because = "every step has a solution, so no increment is truncated";
        take("large-noise", without_iteration, because);
    }
    found
}
