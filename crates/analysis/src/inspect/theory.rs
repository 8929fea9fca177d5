//! Which statements of the paper apply, and the orders that theory predicts.

use serde::Serialize;

use super::{
    casimirs::Casimirs,
    finding::{Finding, Status},
    hamiltonian::Hamiltonians,
    invariants::ClaimedInvariant,
    noises::Noises,
    problem::Bound,
    report::Inspection,
    structure::Structure,
};

/// Whether a statement of the paper applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Applies {
    /// It applies: its assumptions were shown.
    Yes,
    /// It applies if what was found at points holds everywhere, or under a condition that points
    /// cannot decide; the reason names it.
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
    /// How the strong order is known: `Found` where noises were found to commute at the points, or
    /// where formulas may be made of pieces.
    pub known: Status,
}

/// Orders of the schemes of this workspace, of those with Lévy areas if `areas` are drawn. Strong
/// order one takes Lévy areas where noises do not commute, and the terms ½ΔWₘΔW_l fₘ′f_l, which
/// `em` leaves out, where they are not zero. Without
/// noise all but `em` are symmetric or Runge–Kutta methods of order two.
pub fn orders(noises: &Noises, areas: bool) -> Vec<ExpectedOrder> {
    let smooth = if noises.pieces { Status::Found } else { Status::Shown };
    let expected = |(scheme, (strong, weak, known))| ExpectedOrder { scheme, strong, weak, known };
    let listed = |without_areas: (f64, f64, Status), with_areas, em| {
        let (strong, _, status) = without_areas;
        let all = [
            ("sexp", Some(without_areas)),
            ("sexp-levy", areas.then_some(with_areas)),
            ("sexp-li", Some(without_areas)),
            ("sexp-li-levy", areas.then_some(with_areas)),
            ("split", Some(without_areas)),
            ("nv", Some((strong, 2.0, status))),
            ("midpoint", Some(without_areas)),
            ("heun", Some(without_areas)),
            ("em", Some(em)),
        ];
        let listed = all.into_iter().filter_map(|(scheme, order)| Some((scheme, order?)));
        listed.map(expected).collect()
    };
    if noises.silent.holds() {
        let known = noises.silent.status.min(smooth);
        return listed((2.0, 2.0, known), (2.0, 2.0, known), (1.0, 1.0, known));
    }
    // A counterexample shows that the order is ½, unless paths stay where there is none.
    let one_if = |finding: &Finding, on_paths: &Finding| match finding.status {
        Status::Refuted if on_paths.points > 0 && !on_paths.refuted() => {
            (0.5, 1.0, Status::Unknown)
        }
        Status::Refuted => (0.5, 1.0, Status::Shown),
        Status::Unknown => (0.5, 1.0, Status::Unknown),
        holds => (1.0, 1.0, holds.min(smooth)),
    };
    listed(
        one_if(&noises.commute, &noises.on_paths[0]),
        (1.0, 1.0, smooth),
        one_if(&noises.no_correction, &noises.on_paths[1]),
    )
}

/// What a statement that needs this takes.
fn applies(status: Status) -> Applies {
    match status {
        Status::Shown => Applies::Yes,
        Status::Found | Status::Unknown => Applies::Conditionally,
        Status::Refuted => Applies::No,
    }
}

/// `text`, and how it is known.
fn known(text: &str, status: Status) -> String {
    match status {
        Status::Refuted => text.to_owned(),
        _ => format!("{text} ({})", status.name()),
    }
}

/// Without damping the energy is constant where H₁ = cH₀, homogeneous or not, and `sexp` keeps it.
pub fn without_damping(report: &mut Inspection) {
    let hamiltonians = &report.hamiltonians;
    let sound = report.structure.sound();
    let proportional = hamiltonians.proportional.as_ref();
    let energy = proportional.map_or(Status::Refuted, |finding| finding.status).min(sound);
    if hamiltonians.shapes[0].degree.is_some() || !energy.holds() {
        return;
    }
    let exact = hamiltonians.discrete_gradient.holds();
    let but = if exact { "" } else { ", up to the error of ∇̄h" };
    for theorem in report.theorems.iter_mut().filter(|t| t.statement == "energy-balance") {
        theorem.applies = Applies::Conditionally;
        theorem.because = format!("γ = 0 wherever it was looked at, and H₁ = c H₀{but}");
    }
}

/// The schemes that read rates of the damping; the others take its integral.
const READ_RATES: [&str; 3] = ["midpoint", "heun", "em"];

/// The order of a scheme that reads rates of the damping is not known where these are not finite.
pub fn with_unbounded_rate(report: &mut Inspection) {
    report.orders.retain(|order| !READ_RATES.contains(&order.scheme));
}

/// The statements of the paper for a system with these properties.
pub fn theorems(
    structure: &Structure,
    hamiltonians: &Hamiltonians,
    casimirs: &Casimirs,
    noise: &Noises,
    invariants: &[ClaimedInvariant],
    bound: Option<&Bound>,
) -> Vec<Theorem> {
    use Applies::{Conditionally, No, Yes};
    let noises = hamiltonians.shapes.len() - 1;
    let proportional = hamiltonians.proportional.as_ref().map_or(Status::Refuted, |f| f.status);
    // Noises that are multiples of one energy are one noise.
    let multiple = match hamiltonians.noise_size {
        _ if noises == 0 => Some("no noise".to_owned()),
        Some(c) => Some(format!("H₁ = {c} H₀")),
        None => (noises > 1 && proportional.holds()).then(|| "Hₘ = cₘ H₀ for every m".to_owned()),
    };
    let energy_degree = multiple.as_ref().and(hamiltonians.shapes[0].degree);
    let energy_known = proportional.min(hamiltonians.shapes[0].homogeneous.status);
    let listed: Vec<_> =
        casimirs.found.iter().map(|c| (c.formula.clone(), c.casimir.status)).collect();
    let claims = invariants.iter().filter(|i| i.claimed_casimir && i.status().holds());
    let mut laws: Vec<_> = claims.map(|i| (i.name.to_owned(), i.status())).collect();
    laws.extend(listed.iter().cloned());
    if energy_degree.is_some() && energy_known.holds() {
        laws.push(("H₀".into(), energy_known));
    }
    let each = |laws: &[(String, Status)], what| match laws.iter().map(|(_, status)| *status).min()
    {
        Some(worst) => {
            let texts: Vec<_> = laws.iter().map(|(law, status)| known(law, *status)).collect();
            (applies(worst), texts.join("; "))
        }
        None if casimirs.complete == Status::Shown => (No, format!("no {what}")),
        None => (Conditionally, format!("cannot tell whether there is a {what}")),
    };
    let none = "linear or quadratic Casimir, and found no homogeneous energy or true claim";
    let conformal = each(&laws, none);
    let casimir = each(&listed, "linear or quadratic Casimir of B");
    let energy = match (multiple, energy_degree) {
        (Some(noise), Some(p)) if hamiltonians.discrete_gradient.holds() => {
            let status = energy_known.min(hamiltonians.discrete_gradient.status);
            let law = format!("{noise}, H₀ is homogeneous of degree {p}, and ∇̄h is exact");
            (applies(status), known(&law, status))
        }
        (Some(_), Some(_)) => {
            (Conditionally, "up to the error of ∇̄h; take more nodes or a closed form".into())
        }
        (Some(_), None) if energy_known == Status::Refuted => (No, "H₀ is not homogeneous".into()),
        (None, _) if energy_known == Status::Refuted => {
            (No, "there is not one noise with H₁ = c H₀".into())
        }
        _ => (Conditionally, "cannot tell whether H₁ = c H₀ with a homogeneous H₀".into()),
    };
    let bounded = match bound {
        Some(Bound { function, minimum, status, .. }) if minimum.in_domain_only => {
            let condition = "while paths stay in the domain, on which it is positive";
            (Conditionally, known(&format!("m({function}) = {minimum} {condition}"), *status))
        }
        Some(Bound { function, minimum, status, .. }) => {
            (applies(*status), format!("m({function}) = {minimum}"))
        }
        None => (No, "found no linear or quadratic Casimir or energy with m(F) > 0".into()),
    };
    let constant = hamiltonians
        .shapes
        .iter()
        .map(|shape| shape.constant_hessian.status)
        .fold(structure.constant.status, Status::min);
    let (solvable, condition) = match (structure.constant.holds(), bounded.0) {
        (true, _) if constant.holds() => {
            (applies(constant), known("B and the Hessians are constant", constant))
        }
        (true, _) => {
            let condition = "if the second derivatives of all Hamiltonians are bounded";
            (Conditionally, condition.into())
        }
        (false, No) => (Conditionally, "if paths stay in the region of the points".into()),
        (false, _) => (Conditionally, "in the ball of the moment bound".into()),
    };
    // The paper assumes that exact and numerical paths are bounded.
    let orders = match bounded.0 {
        No => (Conditionally, "if all paths stay bounded, which was not proved here".into()),
        _ => bounded.clone(),
    };
    let orders = match orders {
        (_, because) if noise.pieces => {
            (Conditionally, format!("{because}; if B and the energy are smooth"))
        }
        orders => orders,
    };
    let (strong, strong_order) = if noises > 1 {
        ("strong-half", "strong order 1/2 of sexp (k ≥ 1)")
    } else {
        ("strong-one", "strong order 1 of sexp (k ≥ 2)")
    };

    let sound = structure.sound();
    let theorem = |(statement, says, (applies, because))| {
        let (applies, because) = match (sound, applies) {
            (Status::Refuted, _) => (No, "B is not skew-symmetric".into()),
            (Status::Found | Status::Unknown, Yes) => {
                (Conditionally, format!("{because}; B is skew-symmetric ({})", sound.name()))
            }
            _ => (applies, because),
        };
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
            (solvable, condition),
        ),
        (strong, strong_order, orders.clone()),
        ("weak-one", "weak order 1 of sexp (k ≥ 2)", orders),
    ];
    theorems.map(theorem).into()
}
