//! What damping and initial value add: the integral of the damping and a bound of all paths.

use serde::Serialize;
use systems::Damping;

use super::{
    casimirs::{Casimirs, FoundCasimir},
    damping::DampingIntegral,
    erased::System,
    finding::Status,
    function::Minimum,
    hamiltonian::Hamiltonians,
    structure::Structure,
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
    /// How it is known that F obeys the law and that m(F) > 0.
    pub status: Status,
    /// F, if it is a Casimir; else it is H₀.
    #[serde(skip)]
    casimir: Option<FoundCasimir>,
}

impl Bound {
    /// Prefers what is shown to what was found, a bound that holds everywhere to one in the domain,
    /// and a Casimir to the energy.
    pub(super) fn of(
        structure: &Structure,
        hamiltonians: &Hamiltonians,
        casimirs: &Casimirs,
    ) -> Option<Self> {
        let sound = structure.sound();
        let casimir = |found: &FoundCasimir| Self {
            function: found.formula.clone(),
            degree: f64::from(found.degree),
            minimum: found.minimum,
            status: sound.min(found.casimir.status).min(found.minimum.positive),
            casimir: Some(found.clone()),
        };
        let energy = hamiltonians.proportional.as_ref().filter(|finding| finding.holds());
        let energy = energy.and_then(|proportional| {
            let shape = &hamiltonians.shapes[0];
            let (degree, minimum) = (shape.degree?, shape.minimum?);
            let law = proportional.status.min(shape.homogeneous.status);
            let status = sound.min(law).min(minimum.positive);
            Some(Self { function: "H₀".into(), degree, minimum, status, casimir: None })
        });
        let candidates = casimirs.definite.iter().chain(&casimirs.found).map(casimir).chain(energy);
        let positive = candidates.filter(|bound| bound.status.holds() && bound.degree > 0.0);
        positive.min_by_key(|bound| (bound.minimum.in_domain_only, std::cmp::Reverse(bound.status)))
    }

    /// (F(y)/m(F))^{1/p}: the bound of undamped paths from y.
    fn radius(&self, system: &dyn System, y: &[f64]) -> f64 {
        let energy = || system.hamiltonian(0).value(y).value;
        let value = self.casimir.as_ref().map_or_else(energy, |casimir| casimir.form().value(y));
        (value / (self.minimum.value - self.minimum.error)).powf(1.0 / self.degree)
    }
}

/// What was found for one initial value problem.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProblemFindings {
    /// γ in words.
    pub damping: String,
    /// Whether `integral` is the integral of `rate`.
    pub integral: DampingIntegral,
    /// A bound of ‖y(t)‖ for all paths on [0, T], if there is one and the integral of the damping
    /// agrees; as sure as the bound is.
    pub radius: Option<f64>,
}

impl ProblemFindings {
    pub(super) fn of(
        damping: &dyn Damping,
        y0: &[f64],
        t_end: f64,
        system: &dyn System,
        bound: Option<&Bound>,
    ) -> Self {
        let integral = DampingIntegral::of(damping, t_end);
        let radius = bound
            .filter(|_| integral.agrees.holds())
            .map(|bound| bound.radius(system, y0) * (-integral.least).exp());
        Self { damping: damping.describe(), integral, radius }
    }
}
