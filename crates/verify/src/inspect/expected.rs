//! Which statements of the paper apply, and what to expect of each scheme.

use serde::Serialize;

use super::Inspection;
use super::shape::Kind;

/// Whether a statement of the paper applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Applies {
    /// It does.
    Yes,
    /// It does as long as a path stays where the system is defined.
    InDomain,
    /// It does under a condition that points cannot decide; the reason names it.
    Conditionally,
    /// It does not.
    No,
}

/// A statement of the paper and whether it applies.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Theorem {
    /// Its identifier, as in `STATEMENTS`.
    pub statement: &'static str,
    /// What it says.
    pub says: &'static str,
    /// Whether it applies.
    pub applies: Applies,
    /// Why, or why not.
    pub because: String,
}

/// What to expect of a scheme, while paths stay bounded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ExpectedOrder {
    /// Its identifier.
    pub scheme: &'static str,
    /// Strong order.
    pub strong: f64,
    /// Weak order.
    pub weak: f64,
}

/// Orders of the schemes of this workspace: the Taylor expansion asks for Lévy areas where noises
/// do not commute, and for ½ΔWₘΔW_l fₘ′f_l, which `em` leaves out, where that is not zero.
pub(super) fn orders(inspection: &Inspection) -> Vec<ExpectedOrder> {
    let without_areas = if inspection.noise.commute.holds { 1.0 } else { 0.5 };
    let euler = if inspection.noise.no_correction.holds { 1.0 } else { 0.5 };
    let order = |scheme, strong| ExpectedOrder { scheme, strong, weak: 1.0 };
    vec![
        order("sexp", without_areas),
        order("sexp-levy", 1.0),
        order("midpoint", without_areas),
        order("heun", without_areas),
        order("em", euler),
    ]
}

pub(super) fn theorems(inspection: &Inspection) -> Vec<Theorem> {
    let Inspection { structure, hamiltonians, casimirs, invariants, bound, .. } = inspection;
    let skew = structure.skew.holds && structure.linear.holds;
    let yes_if = |condition: bool| if condition && skew { Applies::Yes } else { Applies::No };
    let energy_degree = hamiltonians.noise_size.and(hamiltonians.shapes[0].degree);
    let kept: Vec<&str> = casimirs.found.iter().map(|casimir| casimir.formula.as_str()).collect();
    let other_casimir = invariants.iter().any(|i| i.claimed_casimir && i.mistakes.is_empty());
    let theorem = |statement, says, applies, because| Theorem { statement, says, applies, because };
    let no_skew = "B is not skew".to_owned();

    let lawful = !kept.is_empty() || other_casimir || energy_degree.is_some();
    let exact = theorem(
        "exact-conformal",
        "homogeneous Casimirs, and with one noise the energy, obey exp(−p∫γ)",
        yes_if(lawful),
        if lawful {
            "there is one".to_owned()
        } else {
            "no homogeneous Casimir or energy was found".to_owned()
        },
    );
    let casimir = theorem(
        "conformal-casimir",
        "sexp keeps linear and quadratic Casimirs on their law, at every step of any size",
        yes_if(!kept.is_empty()),
        if kept.is_empty() {
            "B has no linear or quadratic Casimir".to_owned()
        } else {
            kept.join("; ")
        },
    );
    let energy = match (hamiltonians.noise_size, energy_degree) {
        (Some(c), Some(degree)) if hamiltonians.discrete_gradient.holds => (
            yes_if(true),
            format!("H₁ = {c} H₀, H₀ is homogeneous of degree {degree}, and ∇̄ is exact"),
        ),
        (Some(_), Some(_)) => (
            Applies::Conditionally,
            "only as exactly as the quadrature of ∇̄; more nodes or a closed form mend it"
                .to_owned(),
        ),
        (Some(_), None) => (Applies::No, "H₀ is not homogeneous".to_owned()),
        (None, _) if inspection.noises == 1 => {
            (Applies::No, "H₁ is not a multiple of H₀".to_owned())
        }
        (None, _) => (Applies::No, format!("there are {} noises", inspection.noises)),
    };
    let energy = theorem(
        "energy-balance",
        "sexp keeps the energy of a one-noise system on its law, at every step of any size",
        if skew { energy.0 } else { Applies::No },
        if skew { energy.1 } else { no_skew.clone() },
    );

    let (bounded, because) = match bound {
        Some(bound) if bound.minimum.in_domain_only => (
            Applies::InDomain,
            format!("m({}) = {:.3} > 0 on the domain", bound.function, bound.minimum.value),
        ),
        Some(bound) => {
            (Applies::Yes, format!("m({}) = {:.3} > 0", bound.function, bound.minimum.value))
        }
        None => (
            Applies::No,
            "no linear or quadratic Casimir and no energy with m(F) > 0 was found".to_owned(),
        ),
    };
    let bounded = if skew { bounded } else { Applies::No };
    let moment =
        theorem("moment-bound", "all paths stay in a ball that is known", bounded, because.clone());

    let linear =
        structure.constant.holds && hamiltonians.shapes.iter().all(|shape| shape.constant_hessian);
    let solvable = if linear {
        (Applies::Yes, "B and the Hessians are constant: the step is a linear system".to_owned())
    } else if structure.constant.holds {
        (
            Applies::Conditionally,
            "B is constant: if the second derivatives of all Hamiltonians are bounded".to_owned(),
        )
    } else {
        let where_bounded = if bounded == Applies::No {
            "while paths stay in the region looked at"
        } else {
            "by the bound"
        };
        (Applies::Conditionally, where_bounded.to_owned())
    };
    let solvability = theorem(
        "solvability",
        "a step below a known size has one solution",
        solvable.0,
        solvable.1,
    );

    // Assumptions 1 and 2 of the paper are bounds on all paths, exact and numerical.
    let (orders_proven, why) = match bounded {
        Applies::No => (
            Applies::Conditionally,
            "the assumption asks for a bound on all paths, and none follows here; to be expected while they stay bounded".to_owned(),
        ),
        known => (known, because),
    };
    let orders_proven = if skew { orders_proven } else { Applies::No };
    let (id, says) = if inspection.noises > 1 {
        ("strong-half", "strong order 1/2 of sexp (k ≥ 1)")
    } else {
        ("strong-one", "strong order 1 of sexp (k ≥ 2)")
    };
    let strong = theorem(id, says, orders_proven, why.clone());
    let weak = theorem("weak-one", "weak order 1 of sexp (k ≥ 2)", orders_proven, why);
    vec![exact, casimir, energy, moment, solvability, strong, weak]
}

impl Kind {
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Quadratic => "quadratic",
            Self::Homogeneous => "homogeneous",
            Self::NotHomogeneous => "not homogeneous",
        }
    }
}
