//! What damping and initial value add: the integral of the damping and a bound of all paths.

use mc::Friction;
use real::elementary::{exp, powf};
use serde::Serialize;
use systems::{Damping, run_time::System};

use super::{Casimirs, DampingIntegral, Form, FoundCasimir, Hamiltonians, Minimum};
use crate::facts::energy;

/// Function F with a conformal law and m(F) > 0, which bounds exact and numerical paths:
/// ‖y(t)‖ ≤ (F(y₀)/m(F))^{1/p} e^{−∫γ}.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bound {
    /// Degree p of F.
    pub degree: f64,
    /// Minimum m(F) over the unit sphere.
    pub minimum: Minimum,
    /// Function F, if it is a Casimir; `None` if F = H₀.
    #[serde(skip)]
    casimir: Option<Form>,
}

impl Bound {
    /// Finds a bound for a skew-symmetric B. Prefers a bound that holds everywhere to one in the
    /// domain, and a Casimir to the energy.
    pub(super) fn of(hamiltonians: &Hamiltonians, casimirs: &Casimirs) -> Option<Self> {
        let casimir = |FoundCasimir { form, minimum, .. }: &FoundCasimir| Self {
            degree: f64::from(form.degree),
            minimum: *minimum,
            casimir: Some(form.clone()),
        };
        let h0 = hamiltonians.shapes.first().filter(|_| hamiltonians.proportional.holds());
        let energy = h0.and_then(|h0| h0.degree.zip(h0.minimum));
        let energy = energy.map(|(degree, minimum)| Self { degree, minimum, casimir: None });
        let all = casimirs.definite.iter().chain(&casimirs.found).map(casimir).chain(energy);
        let positive = all.filter(|bound| bound.minimum.positive.holds());
        positive.min_by_key(|bound| bound.minimum.in_domain_only)
    }

    /// Radius (F(y)/m(F))^{1/p} that bounds undamped paths from y.
    fn radius(&self, system: &dyn System, y: &[f64]) -> f64 {
        let value = match &self.casimir {
            Some(casimir) => casimir.value(y),
            None => energy(system, y),
        };
        powf(value / self.minimum.value, 1.0 / self.degree)
    }
}

/// Findings on one initial value problem.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProblemFindings {
    /// Damping γ in words, with the friction on single components.
    pub damping: String,
    /// Whether `integral` is the integral of `rate`.
    pub integral: DampingIntegral,
    /// Upper bound of ‖y(t)‖ for all paths on [0, T], if a [`Bound`] was found and the integral of
    /// the damping agrees; as certain as that bound.
    pub radius: Option<f64>,
}

impl ProblemFindings {
    pub(super) fn of(
        ((damping, t_end), friction): ((&dyn Damping, f64), &[Friction]),
        y0: &[f64],
        system: &dyn System,
        bound: Option<&Bound>,
    ) -> Self {
        let mut integral = DampingIntegral::of(damping, t_end);
        for one in friction {
            let other = DampingIntegral::of(&*one.damping, t_end);
            if other.agrees < integral.agrees {
                integral = other;
            }
        }
        let bound = bound.filter(|_| integral.agrees.holds());
        let radius = bound.map(|bound| bound.radius(system, y0) * exp(-integral.least));
        Self { damping: Friction::describe(friction, damping, t_end), integral, radius }
    }
}
