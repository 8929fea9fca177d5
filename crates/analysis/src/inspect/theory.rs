//! Which statements of the paper apply, and the orders that theory predicts.

use schemes::{BuiltIn, Properties, StrongOrder};
use serde::Serialize;

use super::{
    finding::{Finding, Status},
    noises::Noises,
    problem::Bound,
    report::Inspection,
};

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
/// takes Lévy areas where noises do not commute, and the terms ½ΔWₘΔW_l fₘ′f_l, which `em` leaves
/// out, where they are not zero.
pub fn orders(noises: &Noises, areas: bool, finite_rates: bool) -> Vec<ExpectedOrder> {
    // A counterexample shows that the order is ½, unless paths stay where there is none.
    let one_if = |finding: &Finding, on_paths: &Finding| match finding.status {
        Status::Fails if on_paths.points > 0 && !on_paths.fails() => (0.5, Status::Unknown),
        Status::Fails => (0.5, Status::Holds),
        Status::Unknown => (0.5, Status::Unknown),
        Status::Holds => (1.0, Status::Holds),
    };
    let [commute, no_correction] = &noises.on_paths;
    let expected = |scheme: BuiltIn| {
        let Properties { id, strong, weak, without_noise, exact_damping, .. } = scheme.properties();
        if (scheme.is_for_areas() && !areas) || !(exact_damping || finite_rates) {
            return None;
        }
        let ((strong, known), weak) = match strong {
            _ if noises.silent.holds() => ((without_noise, Status::Holds), without_noise),
            StrongOrder::Areas => ((1.0, Status::Holds), weak),
            StrongOrder::Commuting => (one_if(&noises.commute, commute), weak),
            StrongOrder::Additive => (one_if(&noises.no_correction, no_correction), weak),
        };
        Some(ExpectedOrder { scheme: id, strong, weak, known })
    };
    BuiltIn::ALL.into_iter().filter_map(expected).collect()
}

/// The statements of the paper for a system with these properties, with damping or without.
pub fn theorems(report: &Inspection, damped: bool) -> Vec<Theorem> {
    use Applies::{Conditionally, No, Yes};
    let Inspection { structure, hamiltonians, casimirs, invariants, bound, .. } = report;
    let shape = &hamiltonians.shapes[0];
    let exact = hamiltonians.discrete_gradient.holds();
    // Noises that are multiples of one energy are one noise.
    let one_noise = match (report.noises, hamiltonians.noise_size) {
        (0, _) => "no noise".to_owned(),
        (_, Some(c)) => format!("H₁ = {c} H₀"),
        _ => "Hₘ = cₘ H₀ for every m".to_owned(),
    };
    let proportional = hamiltonians.proportional.status;
    let listed: Vec<String> =
        casimirs.iter().flat_map(|c| &c.found).map(|c| c.formula.clone()).collect();
    let claims = invariants.iter().filter(|i| i.claimed_casimir && i.status().holds());
    let mut laws: Vec<String> = claims.map(|i| i.name.to_owned()).collect();
    laws.extend(listed.iter().cloned());
    if proportional.holds() && shape.degree.is_some() {
        laws.push("H₀".into());
    }
    let complete = casimirs.as_ref().is_some_and(|casimirs| casimirs.complete);
    let each = |laws: &[String], what| match (laws, complete) {
        ([], true) => (No, format!("no {what}")),
        ([], false) => (Conditionally, format!("cannot tell whether there is a {what}")),
        _ if laws.len() > 12 => (Yes, format!("{} functions", laws.len())),
        _ => (Yes, laws.join("; ")),
    };
    let none = "linear or quadratic Casimir, and found no homogeneous energy or true claim";
    let inexact = if exact { "" } else { ", up to the error of ∇̄h; take more nodes" };
    let energy = match (proportional, shape.degree) {
        (Status::Holds, Some(p)) => {
            let law = format!("{one_noise}, and H₀ is homogeneous of degree {p}{inexact}");
            (if exact { Yes } else { Conditionally }, law)
        }
        // Without damping the energy is constant, homogeneous or not.
        (Status::Holds, None) if !damped => {
            (Conditionally, format!("γ = 0 wherever it was looked at, and {one_noise}{inexact}"))
        }
        (Status::Holds, None) if shape.homogeneous.fails() => (No, "H₀ is not homogeneous".into()),
        (Status::Fails, _) => (No, "there is not one noise with H₁ = c H₀".into()),
        _ => (Conditionally, "cannot tell whether H₁ = c H₀ with a homogeneous H₀".into()),
    };
    let bounded = match bound {
        Some(Bound { function, minimum, .. }) if minimum.in_domain_only => {
            (Conditionally, format!("m({function}) = {minimum} while paths stay there"))
        }
        Some(Bound { function, minimum, .. }) => (Yes, format!("m({function}) = {minimum}")),
        None => (No, "found no linear or quadratic Casimir or energy with m(F) > 0".into()),
    };
    let quadratic = hamiltonians.shapes.iter().all(|shape| shape.constant_hessian.holds());
    let solvable = match (structure.constant.holds(), bounded.0) {
        (true, _) if quadratic => (Yes, "B and the Hessians are constant".into()),
        (true, _) => (Conditionally, "B is constant; if the Hessians are bounded".into()),
        (false, No) => (Conditionally, "in any ball in which the steps stay".into()),
        (false, _) => (Conditionally, "in the ball of the moment bound".into()),
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
    let sound = structure.sound();
    let theorem = |(statement, says, (applies, because)): (_, _, (Applies, String))| {
        let (applies, because) = match (sound, applies) {
            (Status::Fails, _) => (No, "B is not skew-symmetric".into()),
            (Status::Unknown, Yes) => {
                (Conditionally, format!("{because}; cannot tell whether B is skew-symmetric"))
            }
            _ => (applies, because),
        };
        Theorem { statement, says, applies, because }
    };
    let theorems = [
        (
            "exact-conformal",
            "homogeneous Casimirs (one noise: and the energy) obey exp(−p∫γ)",
            each(&laws, none),
        ),
        (
            "conformal-casimir",
            "sexp keeps linear and quadratic Casimirs on their law for any τ",
            each(&listed, "linear or quadratic Casimir of B"),
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
