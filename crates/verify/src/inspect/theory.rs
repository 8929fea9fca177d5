//! Which statements of the paper apply, and the orders that theory predicts for each scheme.

use serde::Serialize;

use super::casimirs::Casimirs;
use super::hamiltonian::Hamiltonians;
use super::invariants::ClaimedInvariant;
use super::noises::Noises;
use super::problem::Bound;
use super::structure::Structure;

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
pub(super) fn orders(noises: &Noises) -> Vec<ExpectedOrder> {
    let one_if = |condition: bool| if condition { 1.0 } else { 0.5 };
    let without_areas = one_if(noises.commute.holds);
    let order = |(scheme, strong)| ExpectedOrder { scheme, strong, weak: 1.0 };
    let orders = [
        ("sexp", without_areas),
        ("sexp-levy", 1.0),
        ("midpoint", without_areas),
        ("heun", without_areas),
        ("em", one_if(noises.no_correction.holds)),
    ];
    orders.map(order).to_vec()
}

/// Whether a statement applies, and why.
type Answer = (Applies, String);

fn answer(applies: Applies, because: &str) -> Answer {
    (applies, because.to_owned())
}

/// The statements of the paper for a system with these properties.
pub(super) fn theorems(
    structure: &Structure,
    hamiltonians: &Hamiltonians,
    casimirs: &Casimirs,
    invariants: &[ClaimedInvariant],
    bound: Option<&Bound>,
) -> Vec<Theorem> {
    let skew = structure.skew.holds && structure.linear.holds;
    let needs_skew =
        |answer: Answer| if skew { answer } else { (Applies::No, "B is not skew".to_owned()) };
    let noises = hamiltonians.shapes.len() - 1;
    let bounded = needs_skew(bounded(bound));
    let order = needs_skew(orders_proven(&bounded));
    let (strong, strong_order) = if noises > 1 {
        ("strong-half", "strong order 1/2 of sexp (k ≥ 1)")
    } else {
        ("strong-one", "strong order 1 of sexp (k ≥ 2)")
    };
    let theorem = |(statement, says, (applies, because)): (&'static str, &'static str, Answer)| {
        Theorem { statement, says, applies, because }
    };
    let theorems = [
        (
            "exact-conformal",
            "homogeneous Casimirs, and with one noise the energy, obey exp(−p∫γ)",
            needs_skew(conformal(hamiltonians, casimirs, invariants)),
        ),
        (
            "conformal-casimir",
            "sexp preserves the law of linear and quadratic Casimirs at any step size",
            needs_skew(casimirs_preserved(casimirs)),
        ),
        (
            "energy-balance",
            "sexp preserves the law of the energy of a one-noise system at any step size",
            needs_skew(energy_preserved(hamiltonians)),
        ),
        ("moment-bound", "all paths stay in a known ball", bounded.clone()),
        (
            "solvability",
            "an implicit step below a known size has exactly one solution",
            solvable(structure, hamiltonians, bounded.0 != Applies::No),
        ),
        (strong, strong_order, order.clone()),
        ("weak-one", "weak order 1 of sexp (k ≥ 2)", order),
    ];
    theorems.map(theorem).into()
}

/// p of a homogeneous energy that the noise preserves.
fn energy_degree(hamiltonians: &Hamiltonians) -> Option<f64> {
    hamiltonians.noise_size.and(hamiltonians.shapes[0].degree)
}

fn conformal(
    hamiltonians: &Hamiltonians,
    casimirs: &Casimirs,
    invariants: &[ClaimedInvariant],
) -> Answer {
    let claimed = invariants.iter().any(|i| i.claimed_casimir && i.mistakes.is_empty());
    if claimed || !casimirs.found.is_empty() || energy_degree(hamiltonians).is_some() {
        answer(Applies::Yes, "there is one")
    } else {
        answer(Applies::No, "no homogeneous Casimir or energy was found")
    }
}

fn casimirs_preserved(casimirs: &Casimirs) -> Answer {
    let formulas: Vec<&str> = casimirs.found.iter().map(|c| c.formula.as_str()).collect();
    if formulas.is_empty() {
        answer(Applies::No, "B has no linear or quadratic Casimir")
    } else {
        (Applies::Yes, formulas.join("; "))
    }
}

fn energy_preserved(hamiltonians: &Hamiltonians) -> Answer {
    match (hamiltonians.noise_size, energy_degree(hamiltonians)) {
        (Some(c), Some(degree)) if hamiltonians.discrete_gradient.holds => (
            Applies::Yes,
            format!("H₁ = {c} H₀, H₀ is homogeneous of degree {degree}, and ∇̄h is exact"),
        ),
        (Some(_), Some(_)) => answer(
            Applies::Conditionally,
            "up to the error of the quadrature of ∇̄h; take more nodes or a closed form",
        ),
        (Some(_), None) => answer(Applies::No, "H₀ is not homogeneous"),
        (None, _) => match hamiltonians.shapes.len() - 1 {
            1 => answer(Applies::No, "H₁ is not a multiple of H₀"),
            noises => (Applies::No, format!("there are {noises} noises")),
        },
    }
}

fn bounded(bound: Option<&Bound>) -> Answer {
    let Some(Bound { function, minimum, .. }) = bound else {
        let because = "no linear or quadratic Casimir and no energy with m(F) > 0 was found";
        return answer(Applies::No, because);
    };
    let (applies, domain) = if minimum.in_domain_only {
        (Applies::InDomain, " on the domain")
    } else {
        (Applies::Yes, "")
    };
    (applies, format!("m({function}) = {:.3} > 0{domain}", minimum.value))
}

fn solvable(structure: &Structure, hamiltonians: &Hamiltonians, bounded: bool) -> Answer {
    if !structure.constant.holds {
        let condition = if bounded {
            "by the bound of all paths"
        } else {
            "if paths stay in the region of the points"
        };
        answer(Applies::Conditionally, condition)
    } else if hamiltonians.shapes.iter().all(|shape| shape.constant_hessian) {
        answer(Applies::Yes, "B and the Hessians are constant: the step is a linear system")
    } else {
        answer(
            Applies::Conditionally,
            "B is constant: if the second derivatives of all Hamiltonians are bounded",
        )
    }
}

/// The paper proves the orders for bounded paths, exact and numerical (its assumptions 1 and 2).
fn orders_proven(bounded: &Answer) -> Answer {
    match bounded.0 {
        Applies::No => {
            answer(Applies::Conditionally, "if all paths stay bounded, which was not proved here")
        }
        _ => bounded.clone(),
    }
}
