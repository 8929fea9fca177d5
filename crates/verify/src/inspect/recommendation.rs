//! Which scheme to take, for what.

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
    /// Paths on which Casimirs matter and the energy does not.
    Casimirs,
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
            Self::Casimirs => "for paths, if the energy does not matter",
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

/// What a problem adds to its system.
#[derive(Clone, Copy, Debug)]
pub struct Circumstances {
    /// Whether there is damping.
    pub damped: bool,
    /// Whether the rate of the damping is finite.
    pub finite_rate: bool,
}

/// The schemes to take, that for paths first.
pub fn recommendations(report: &Inspection, circumstances: Circumstances) -> Vec<Recommendation> {
    let Inspection { structure, hamiltonians, casimirs, noise, without_iteration, .. } = report;
    let sound = structure.sound() != Status::Refuted;
    // Sums of logarithms are kept by flows alone.
    let nothing = match casimirs.logarithmic.is_empty() {
        true => "nothing was found to keep",
        false => "split alone keeps the Casimir with logarithms",
    };
    let casimirs = sound && !casimirs.found.is_empty();
    let energy = sound
        && hamiltonians.proportional.as_ref().is_some_and(Finding::holds)
        && (hamiltonians.shapes[0].degree.is_some() || !circumstances.damped);
    let linear = without_iteration.refused.is_none();
    let commuting = noise.commute.holds();
    let areas = !commuting && without_iteration.draws_areas;
    let mut found = Vec::new();
    let mut take = |purpose, scheme, because: &str| {
        found.push(Recommendation { purpose, scheme, because: because.into() });
    };

    if areas {
        let because = match noise.commute.status {
            Status::Refuted => "noises do not commute, and Lévy areas give strong order 1",
            _ => "strong order 1 whether noises commute or not",
        };
        match without_iteration.areas_refused {
            None => take(Purpose::Paths, "sexp-li-levy", &format!("{because}; no iteration")),
            Some(_) => take(Purpose::Paths, "sexp-levy", because),
        }
    } else if energy {
        let kept = match (casimirs, circumstances.damped) {
            (true, _) => "it keeps the energy and the Casimirs",
            (false, true) => "it keeps the energy",
            (false, false) => "it keeps the energy, since there is no damping",
        };
        let exact = hamiltonians.discrete_gradient.holds();
        let but = if exact { "" } else { "; the energy up to the error of ∇̄h" };
        take(Purpose::Paths, "sexp", &format!("{kept}{but}"));
        if casimirs && linear {
            let because = "it keeps the Casimirs at about the price of heun";
            take(Purpose::Casimirs, "sexp-li", because);
        }
    } else if casimirs && linear {
        take(Purpose::Paths, "sexp-li", "it keeps the Casimirs at about the price of heun");
    } else if casimirs {
        take(Purpose::Paths, "sexp", "it keeps the Casimirs, and B is not affine in y");
    } else if !circumstances.finite_rate {
        let because = "it takes the integral of the damping, whose rate is not finite";
        take(Purpose::Paths, if linear { "sexp-li" } else { "sexp" }, because);
    } else if noise.silent.holds() {
        take(Purpose::Paths, "heun", &format!("explicit, of order 2; {nothing}"));
    } else {
        let order = if commuting { "1" } else { "1/2, since the noises do not commute" };
        take(Purpose::Paths, "heun", &format!("explicit, of strong order {order}; {nothing}"));
    }

    let random = !noise.silent.holds();
    if random && linear {
        let because = "mc::expect extrapolates weak order 1; with flows of parts take nv";
        take(Purpose::Expectations, "sexp-li", because);
    } else if random && areas {
        let because = "weak order 1 takes no areas";
        let kept = casimirs || !circumstances.finite_rate;
        take(Purpose::Expectations, if kept { "sexp" } else { "heun" }, because);
    }
    // With a constant B the scheme is explicit, and large steps grow.
    let implicit = linear && without_iteration.structure == Linearity::Affine;
    if sound && implicit && !without_iteration.truncates && random {
        let because = "every step has a solution, so no increment is truncated";
        let scheme = if areas && without_iteration.areas_refused.is_none() {
            "sexp-li or sexp-li-levy"
        } else {
            "sexp-li"
        };
        take(Purpose::LargeNoise, scheme, because);
    }
    found
}
