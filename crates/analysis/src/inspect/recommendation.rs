//! Which scheme to take, for what: one rule for `inspect`, `run` and `recommend`.
//!
//! | scheme | damping | Casimirs of degree 1, 2 | energy over long times |
//! |---|---|---|---|
//! | `sexp`, `sexp-levy` | exact | kept | kept but for the noise |
//! | `split`, `nv` | exact | kept, of any degree where flows are exact | stays near |
//! | `sexp-li`, `sexp-li-levy` | exact | kept; explicit where B is constant | drifts |
//! | `midpoint` | of order 2 | kept without damping | stays near without damping |
//! | `heun`, `em` | of order 2, 1 | lost | drifts, or explodes |
//!
//! So paths are for `sexp`, with Lévy areas where noises do not commute and areas are drawn; for
//! `split` where a step of `sexp` is dear and flows are known, as on a lattice. `heun` and `em` are
//! for those who name them.

use serde::Serialize;
use systems::Linearity;

use super::{
    finding::{Finding, Status},
    report::Inspection,
};

/// What a scheme is wanted for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Purpose {
    /// Paths: strong order, and everything kept that can be.
    Paths,
    /// Paths that are too short for the energy to drift.
    ShortPaths,
    /// Expectations.
    Expectations,
    /// Steps with large increments.
    LargeNoise,
}

impl Purpose {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Paths => "for paths",
            Self::ShortPaths => "for short paths",
            Self::Expectations => "for expectations",
            Self::LargeNoise => "for large noise",
        }
    }
}

/// A scheme to take.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Recommendation {
    /// What for.
    pub purpose: Purpose,
    /// Its identifier.
    pub scheme: &'static str,
    /// Why.
    pub because: String,
}

/// What a scheme for paths has to care for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Kept {
    /// There are linear or quadratic Casimirs.
    pub casimirs: bool,
    /// The equation has an energy law: every noise is a multiple of H₀, which is homogeneous or
    /// not damped.
    pub energy: bool,
    /// Noises do not commute, and Lévy areas are drawn.
    pub areas: bool,
}

impl Kept {
    /// The scheme for paths, and why.
    pub fn scheme(self) -> (&'static str, String) {
        let kept = match (self.casimirs, self.energy) {
            (true, true) => "it keeps the energy and the Casimirs",
            (false, true) => "it keeps the energy",
            (true, false) => "it keeps the Casimirs, and the energy but for the noise",
            (false, false) => "it damps exactly, and keeps the energy but for the noise",
        };
        match self.areas {
            true => ("sexp-levy", format!("{kept}; Lévy areas give strong order 1")),
            false => ("sexp", kept.into()),
        }
    }
}

/// What a scheme does over long times. `constant`: B does not depend on y.
pub fn long_times(scheme: &str, constant: bool) -> &'static str {
    match scheme {
        "sexp" | "sexp-levy" => "exact damping; Casimirs and, but for the noise, the energy kept",
        "sexp-li" | "sexp-li-levy" if constant => {
            "exact damping; explicit, since B is constant: the energy drifts"
        }
        "sexp-li" | "sexp-li-levy" => "exact damping; Casimirs kept; the energy drifts",
        "split" | "nv" => {
            "exact damping; Casimirs kept; the energy stays near where flows are exact"
        }
        "midpoint" => "without damping Casimirs are kept, and the energy stays near",
        _ => "nothing is kept: the energy drifts, or explodes",
    }
}

/// The schemes to take for a system with damping or without, that for paths first.
pub fn recommendations(report: &Inspection, damped: bool) -> Vec<Recommendation> {
    let Inspection { structure, hamiltonians, casimirs, noise, without_iteration, .. } = report;
    let sound = structure.sound() != Status::Refuted;
    let casimirs = sound && !casimirs.found.is_empty();
    let energy = sound
        && hamiltonians.proportional.as_ref().is_some_and(Finding::holds)
        && (hamiltonians.shapes[0].degree.is_some() || !damped);
    let linear = without_iteration.refused.is_none();
    let areas = !noise.commute.holds() && without_iteration.draws_areas;
    let mut found = Vec::new();
    let mut take = |purpose, scheme, because: String| {
        found.push(Recommendation { purpose, scheme, because });
    };
    let (scheme, mut because) = Kept { casimirs, energy, areas }.scheme();
    if !hamiltonians.discrete_gradient.holds() {
        because += "; the energy up to the error of ∇̄h";
    }
    if !report.casimirs.logarithmic.is_empty() {
        because += "; split alone keeps the Casimir with logarithms";
    }
    take(Purpose::Paths, scheme, because);
    let implicit = linear && without_iteration.structure == Linearity::Affine;
    let without_iteration_too = match areas && without_iteration.areas_refused.is_none() {
        true => "sexp-li-levy",
        false => "sexp-li",
    };
    if casimirs && implicit {
        let because = "it keeps the Casimirs at about the price of heun, and the energy drifts";
        take(Purpose::ShortPaths, without_iteration_too, because.into());
    }
    let random = !noise.silent.holds();
    if random && linear {
        let because = "mc::expect extrapolates weak order 1; with flows of parts take nv";
        // Without iteration a step is explicit where B is constant.
        let scheme =
            if without_iteration.structure == Linearity::Constant { "sexp" } else { "sexp-li" };
        take(Purpose::Expectations, scheme, because.into());
    } else if random && areas {
        take(Purpose::Expectations, "sexp", "weak order 1 takes no areas".into());
    }
    // With a constant B the scheme is explicit, and large steps grow.
    if sound && implicit && !report.without_iteration.truncates && random {
        let because = "every step has a solution, so no increment is truncated";
        take(Purpose::LargeNoise, without_iteration_too, because.into());
    }
    found
}
