//! Which scheme to take for a system, for what.

use schemes::SexpLi;
use serde::Serialize;
use systems::{Linearity, run_time::System};

use super::{InspectSettings, finding::Status, report::Inspection};
use crate::facts::Kept;

/// A scheme to take.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Recommendation {
    /// What for: `paths` or `expectations`.
    pub purpose: &'static str,
    /// Its identifier.
    pub scheme: &'static str,
    /// Why.
    pub because: String,
}

/// The schemes to take for a system with damping or without, that for paths first.
pub fn recommendations(
    report: &Inspection,
    system: &dyn System,
    settings: &InspectSettings<'_>,
    damped: bool,
) -> Vec<Recommendation> {
    let Inspection { structure, hamiltonians, casimirs, noise, .. } = report;
    // Which laws friction leaves is not looked at here.
    let sound = structure.sound() != Status::Fails && settings.friction.is_empty();
    let claims = report.invariants.iter().any(|i| i.claimed_casimir && i.status().holds());
    let found = casimirs.as_ref().map_or(claims, |casimirs| !casimirs.found.is_empty());
    let lawful = hamiltonians.shapes[0].degree.is_some() || !damped;
    let kept = Kept {
        casimirs: sound && found,
        energy: sound && hamiltonians.proportional.holds() && lawful,
        areas: settings.areas && !noise.commute.holds(),
        noise: !hamiltonians.silent && report.noises > 0,
        damped: damped || !settings.friction.is_empty(),
    };
    let (scheme, mut because) = settings.run.clone().unwrap_or_else(|| kept.scheme(system));
    if !hamiltonians.discrete_gradient.holds() && ["sexp", "sexp-levy"].contains(&scheme) {
        because += "; the energy up to the error of ∇̄h";
    }
    if casimirs.as_ref().is_some_and(|casimirs| !casimirs.logarithmic.is_empty()) {
        because += "; split alone keeps the Casimir with logarithms";
    }
    let mut found = vec![Recommendation { purpose: "paths", scheme, because }];
    let linear = SexpLi::at_run_time(system).is_ok();
    if !hamiltonians.silent && (linear || kept.areas) {
        // Without iteration a step is explicit where B is constant.
        let implicit = linear && system.description().linearity == Linearity::Affine;
        let scheme = if implicit { "sexp-li" } else { "sexp" };
        let because = "weak order 1 is extrapolated; with flows of parts take nv".into();
        found.push(Recommendation { purpose: "expectations", scheme, because });
    }
    found
}
