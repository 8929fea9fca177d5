//! Which statements of the paper apply, and the orders that theory predicts.

use schemes::{BuiltIn, Properties, StrongOrder};
use serde::Serialize;

use super::{finding::Status, problem::Bound, report::Inspection};

/// Whether a statement of the paper applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Applies {
    /// It applies: its assumptions hold wherever they were looked at.
    Yes,
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
    /// Strong order; of an unknown one, the least.
    pub strong: f64,
    /// Weak order.
    pub weak: f64,
    /// `Unknown` if the strong order may be higher.
    pub known: Status,
}

/// Orders of the [built-in schemes](BuiltIn) for smooth B and H, of those with Lévy areas if
/// `areas` are drawn, of those that read rates of the damping if these are finite. Strong order one
/// takes Lévy areas where noises do not commute. That of `em` is ½ at least.
pub fn orders(report: &Inspection, finite_rates: bool) -> Vec<ExpectedOrder> {
    let noise = &report.noise;
    // A counterexample shows that the order is ½, unless paths stay where there is none.
    let commuting = match noise.commute.status {
        Status::Fails if noise.at_start.points > 0 && !noise.at_start.fails() => {
            (0.5, Status::Unknown)
        }
        Status::Fails => (0.5, Status::Holds),
        Status::Unknown => (0.5, Status::Unknown),
        Status::Holds => (1.0, Status::Holds),
    };
    let expected = |scheme: BuiltIn| {
        let Properties { id, strong, weak, without_noise, exact_damping, .. } = scheme.properties();
        let areas = !scheme.is_for_areas() || report.schemes.draws_areas;
        let ((strong, known), weak) = match strong {
            _ if report.hamiltonians.silent() => ((without_noise, Status::Holds), without_noise),
            StrongOrder::Areas => ((1.0, Status::Holds), weak),
            StrongOrder::Commuting => (commuting, weak),
            StrongOrder::Additive => ((0.5, Status::Unknown), weak),
        };
        let expected = ExpectedOrder { scheme: id, strong, weak, known };
        (areas && (exact_damping || finite_rates)).then_some(expected)
    };
    BuiltIn::ALL.into_iter().filter_map(expected).collect()
}

/// The statements of the paper for a system with these properties, with damping or without.
pub fn theorems(report: &Inspection, damped: bool) -> Vec<Theorem> {
    use Applies::{Conditionally, No, Yes};
    let Inspection { structure, hamiltonians, casimirs, invariants, bound, .. } = report;
    let (shape, proportional) = (&hamiltonians.shapes[0], hamiltonians.proportional.status);
    let listed = casimirs.iter().flat_map(|c| &c.found).map(|c| c.formula.clone());
    let listed: Vec<String> = listed.collect();
    let claims = invariants.iter().filter(|i| i.claimed_casimir && i.status().holds());
    let claims = claims.map(|i| i.name.to_owned());
    let energy = (proportional.holds() && shape.degree.is_some()).then(|| "H₀".to_owned());
    let laws: Vec<String> = claims.chain(listed.clone()).chain(energy).collect();
    let complete = casimirs.as_ref().is_some_and(|casimirs| casimirs.complete);
    let each = |laws: &[String]| match laws.len() {
        0 if complete => (No, "there is none".to_owned()),
        0 => (Conditionally, "none was found".into()),
        1..=12 => (Yes, laws.join("; ")),
        many => (Yes, format!("{many} functions")),
    };
    let energy = match (proportional, shape.degree) {
        (Status::Fails, _) => (No, "not every Hₘ is a multiple of H₀".into()),
        (Status::Holds, None) if damped && shape.homogeneous.fails() => {
            (No, "H₀ is not homogeneous".into())
        }
        (Status::Holds, Some(p)) if hamiltonians.discrete_gradient.holds() => {
            (Yes, format!("every Hₘ is a multiple of H₀, homogeneous of degree {p}"))
        }
        (Status::Holds, Some(_)) => (Conditionally, "up to the error of ∇̄h".into()),
        // Without damping the energy is constant, homogeneous or not.
        (Status::Holds, None) if !damped => (Conditionally, "while there is no damping".into()),
        _ => (Conditionally, "cannot tell whether every Hₘ is a multiple of H₀".into()),
    };
    let bounded = match bound {
        Some(Bound { function, minimum, .. }) => {
            let applies = if minimum.in_domain_only { Conditionally } else { Yes };
            (applies, format!("m({function}) = {minimum}"))
        }
        None => (No, "found no Casimir or energy with m(F) > 0".into()),
    };
    let quadratic = hamiltonians.shapes.iter().all(|shape| shape.constant_hessian.holds());
    let solvable = match structure.constant.holds() {
        true if quadratic => (Yes, "B and the Hessians are constant".into()),
        true => (Conditionally, "B is constant; if the Hessians are bounded".into()),
        false => (Conditionally, "in any ball in which the steps stay".into()),
    };
    // The paper assumes that exact and numerical paths are bounded.
    let orders = match bounded.0 {
        No => (Conditionally, "if all paths stay bounded, which was not found".into()),
        _ => bounded.clone(),
    };
    let (strong, strong_order) = match report.noises {
        0 | 1 => ("strong-one", "strong order 1 of sexp (k ≥ 2), for smooth B and H"),
        _ => ("strong-half", "strong order 1/2 of sexp (k ≥ 1), for smooth B and H"),
    };
    let theorem = |(statement, says, (applies, because)): (_, _, (Applies, String))| {
        let (applies, because) = match (structure.sound(), applies) {
            (Status::Fails, _) => (No, "B is not skew-symmetric".into()),
            (Status::Unknown, Yes) => (Conditionally, format!("{because}, if B is skew-symmetric")),
            _ => (applies, because),
        };
        Theorem { statement, says, applies, because }
    };
    let theorems = [
        (
            "exact-conformal",
            "homogeneous Casimirs (one noise: and the energy) obey exp(−p∫γ)",
            each(&laws),
        ),
        (
            "conformal-casimir",
            "sexp keeps linear and quadratic Casimirs on their law for any τ",
            each(&listed),
        ),
        (
            "energy-balance",
            "sexp keeps the energy of a one-noise system on its law for any τ",
            energy,
        ),
        ("moment-bound", "all paths stay in a known ball", bounded),
        ("solvability", "an implicit step below a known size has exactly one solution", solvable),
        (strong, strong_order, orders.clone()),
        ("weak-one", "weak order 1 of sexp (k ≥ 2), for smooth B and H", orders),
    ];
    theorems.map(theorem).into()
}
