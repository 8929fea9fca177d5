//! Which statements of the paper apply, and the orders that theory predicts for each scheme.

use serde::Serialize;

use super::{
    casimirs::Casimirs, hamiltonian::Hamiltonians, invariants::ClaimedInvariant, noises::Noises,
    problem::Bound, structure::Structure,
};

/// Whether a statement of the paper applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Applies {
    /// It applies.
    Yes,
    /// It applies as long as a path stays in the domain of the system.
    InDomain,
    /// It applies under a condition that points cannot decide; the reason names it.
    Conditionally,
    /// It does not apply.
    No,
}

/// A statement of the paper and whether it applies.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Theorem {
    /// Its identifier, as in `STATEMENTS`.
    pub statement: &'static str,
    /// The statement in a few words.
    pub says: &'static str,
    /// Whether it applies.
    pub applies: Applies,
    /// Why, or why not.
    pub because: String,
}

/// The orders that theory predicts for a scheme while paths stay bounded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ExpectedOrder {
    /// The identifier of the scheme.
    pub scheme: &'static str,
    /// Strong order.
    pub strong: f64,
    /// Weak order.
    pub weak: f64,
}

/// Orders of the schemes of this workspace. Strong order one takes Lévy areas where noises do not
/// commute, and the terms ½ΔWₘΔW_l fₘ′f_l, which `em` leaves out, where they are not zero.
pub fn orders(noises: &Noises) -> Vec<ExpectedOrder> {
    let one_if = |condition| if condition { 1.0 } else { 0.5 };
    let without_areas = one_if(noises.commute.holds);
    let orders = [
        ("sexp", without_areas),
        ("sexp-levy", 1.0),
        ("midpoint", without_areas),
        ("heun", without_areas),
        ("em", one_if(noises.no_correction.holds)),
    ];
    orders.map(|(scheme, strong)| ExpectedOrder { scheme, strong, weak: 1.0 }).into()
}

/// The statements of the paper for a system with these properties.
pub fn theorems(
    structure: &Structure,
    hamiltonians: &Hamiltonians,
    casimirs: &Casimirs,
    invariants: &[ClaimedInvariant],
    bound: Option<&Bound>,
) -> Vec<Theorem> {
    use Applies::{Conditionally, InDomain, No, Yes};
    let noises = hamiltonians.shapes.len() - 1;
    let energy_degree = hamiltonians.noise_size.and(hamiltonians.shapes[0].degree);
    let casimir = invariants.iter().any(|i| i.claimed_casimir && i.mistakes.is_empty());
    let formulas: Vec<&str> = casimirs.found.iter().map(|c| c.formula.as_str()).collect();

    let conformal = if casimir || !formulas.is_empty() || energy_degree.is_some() {
        (Yes, "there is one".into())
    } else {
        (No, "no homogeneous Casimir or energy was found".into())
    };
    let casimir = if formulas.is_empty() {
        (No, "B has no linear or quadratic Casimir".into())
    } else {
        (Yes, formulas.join("; "))
    };
    let energy = match (hamiltonians.noise_size, energy_degree) {
        (Some(c), Some(p)) if hamiltonians.discrete_gradient.holds => {
            (Yes, format!("H₁ = {c} H₀, H₀ is homogeneous of degree {p}, and ∇̄h is exact"))
        }
        (Some(_), Some(_)) => {
            (Conditionally, "up to the error of ∇̄h; take more nodes or a closed form".into())
        }
        (Some(_), None) => (No, "H₀ is not homogeneous".into()),
        (None, _) => (No, "there is not one noise with H₁ = c H₀".into()),
    };
    let bounded = match bound {
        Some(Bound { function, minimum, .. }) => (
            if minimum.in_domain_only { InDomain } else { Yes },
            format!("m({function}) = {minimum}"),
        ),
        None => (No, "found no linear or quadratic Casimir or energy with m(F) > 0".into()),
    };
    let constant_hessians = hamiltonians.shapes.iter().all(|shape| shape.constant_hessian);
    let (solvable, condition) = match (structure.constant.holds, bounded.0) {
        (true, _) if constant_hessians => (Yes, "B and the Hessians are constant"),
        (true, _) => (Conditionally, "if the second derivatives of all Hamiltonians are bounded"),
        (false, No) => (Conditionally, "if paths stay in the region of the points"),
        (false, _) => (Conditionally, "in the ball of the moment bound"),
    };
    // The paper assumes that exact and numerical paths are bounded.
    let orders = match bounded.0 {
        No => (Conditionally, "if all paths stay bounded, which was not proved here".into()),
        _ => bounded.clone(),
    };
    let (strong, strong_order) = if noises > 1 {
        ("strong-half", "strong order 1/2 of sexp (k ≥ 1)")
    } else {
        ("strong-one", "strong order 1 of sexp (k ≥ 2)")
    };

    let skew = structure.skew.holds && structure.linear.holds;
    let theorem = |(statement, says, (applies, because))| {
        let (applies, because) =
            if skew { (applies, because) } else { (No, "B is not skew-symmetric".into()) };
        Theorem { statement, says, applies, because }
    };
    let theorems = [
        (
            "exact-conformal",
            "homogeneous Casimirs (one noise: and the energy) obey exp(−p∫γ)",
            conformal,
        ),
        (
            "conformal-casimir",
            "sexp keeps linear and quadratic Casimirs on their law for any τ",
            casimir,
        ),
        (
            "energy-balance",
            "sexp keeps the energy of a one-noise system on its law for any τ",
            energy,
        ),
        ("moment-bound", "all paths stay in a known ball", bounded),
        (
            "solvability",
            "an implicit step below a known size has exactly one solution",
            (solvable, condition.into()),
        ),
        (strong, strong_order, orders.clone()),
        ("weak-one", "weak order 1 of sexp (k ≥ 2)", orders),
    ];
    theorems.map(theorem).into()
}
