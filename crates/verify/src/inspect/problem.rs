//! What damping and initial value add: the integral of the damping and a bound of all paths.

use serde::Serialize;
use systems::{Damping, Problem, paper::valid};

use super::{
    casimirs::{Casimirs, FoundCasimir},
    erased::System,
    finding::Finding,
    function::Minimum,
    hamiltonian::Hamiltonians,
};

/// A function F with a conformal law and m(F) > 0, which bounds exact and numerical paths:
/// ‖y(t)‖ ≤ (F(y₀)/m(F))^{1/p} e^{−∫γ}.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bound {
    /// F.
    pub function: String,
    /// p.
    pub degree: f64,
    /// m(F).
    pub minimum: Minimum,
    /// F, if it is a Casimir; else it is H₀.
    #[serde(skip)]
    casimir: Option<FoundCasimir>,
}

impl Bound {
    /// Prefers a bound that holds everywhere to one in the domain, and a Casimir to the energy.
    pub(super) fn of(hamiltonians: &Hamiltonians, casimirs: &Casimirs) -> Option<Self> {
        let casimir = |found: &FoundCasimir| Self {
            function: found.formula.clone(),
            degree: f64::from(found.degree),
            minimum: found.minimum,
            casimir: Some(found.clone()),
        };
        let energy = hamiltonians.noise_size.and_then(|_| {
            let shape = &hamiltonians.shapes[0];
            let (degree, minimum) = (shape.degree?, shape.minimum?);
            Some(Self { function: "H₀".into(), degree, minimum, casimir: None })
        });
        let candidates = casimirs.definite.iter().chain(&casimirs.found).map(casimir).chain(energy);
        let positive = candidates.filter(|bound| bound.minimum.positive && bound.degree > 0.0);
        positive.min_by_key(|bound| bound.minimum.in_domain_only)
    }

    /// (F(y)/m(F))^{1/p}: the bound of undamped paths from y.
    fn radius(&self, system: &dyn System, y: &[f64]) -> f64 {
        let energy = || system.hamiltonian(0).value(y);
        let value = self.casimir.as_ref().map_or_else(energy, |casimir| casimir.value(y));
        (value / self.minimum.value).powf(1.0 / self.degree)
    }
}

/// What was found for one initial value problem.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProblemFindings {
    /// γ in words.
    pub damping: String,
    /// `integral` is the integral of `rate`, by quadrature on each of 1024 parts of [0, T].
    pub integral: Finding,
    /// Whether they agree to six digits over [0, T] and on all parts but 16, in which γ may jump.
    pub integral_agrees: bool,
    /// A bound of ‖y(t)‖ for all paths on [0, T], if there is one.
    pub radius: Option<f64>,
}

/// Parts of [0, T].
const PARTS: u32 = 1024;
/// Nodes on each part: round-off for any γ that is smooth on a thousandth of [0, T].
const NODES: usize = 8;
/// Relative tolerance: far above the error of a closed form or a quadrature, far below that of a
/// wrong formula.
const AGREEMENT: f64 = 1e-6;
/// Parts in which γ may jump or bend; there the quadrature is wrong by no more than the part.
const JUMPS: u32 = PARTS / 64;

impl ProblemFindings {
    pub(super) fn of<S, G: Damping, const D: usize>(
        problem: &Problem<S, G, D>,
        system: &dyn System,
        bound: Option<&Bound>,
    ) -> Self {
        let (damping, y0, t_end) = (problem.damping(), problem.y0(), problem.t_end());
        let rule = valid(dgrad::Rule::new(NODES));
        let time = |n: u32| t_end * f64::from(n) / f64::from(PARTS);
        let mut integral = Finding::default();
        // ∫γ so far and its least value, ∫|γ| so far.
        let (mut damped, mut least, mut total) = (0.0, 0.0f64, 0.0);
        let (mut disagreeing, mut difference) = (0, 0.0);
        for n in 0..PARTS {
            let (a, b) = (time(n), time(n + 1));
            let size = rule.integrate(a, b, |t| damping.rate(t).abs());
            let exact = rule.integrate(a, b, |t| damping.rate(t));
            let given = damping.integral(a, b);
            total += size;
            let scale = size.max(total / f64::from(n + 1));
            integral.record(given - exact, scale, &[a]);
            let agree = (given - exact).abs() <= AGREEMENT * scale;
            disagreeing += u32::from(!agree);
            difference += given - exact;
            damped += given;
            least = least.min(damped);
        }
        let integral_agrees = disagreeing <= JUMPS
            && difference.abs() <= total * f64::from(disagreeing.max(1)) / f64::from(PARTS);
        let radius = bound.map(|bound| bound.radius(system, &y0) * (-least).exp());
        Self { damping: damping.describe(), integral, integral_agrees, radius }
    }
}
