//! The stochastic midpoint rule.

use nonlin::Solver;

use crate::{Implicit, Increment};

/// The stochastic midpoint rule, `midpoint` (Milstein, Repin and Tretyakov 2002).
///
/// y_{n+1} = y_n + B(ȳ)∇h(ȳ) − τγ(t_{n+½})ȳ,  ȳ = (y_n + y_{n+1})/2,  h = H₀τ + Σ HₘΔŴₘ.
///
/// Strong order 1 for one noise or noises that commute, ½ otherwise; weak order 1. Keeps quadratic
/// Casimirs where γ = 0. With damping it takes 2τγC(ȳ) from them, which depends on the path, instead
/// of multiplying them by e^{−2∫γ}; linear ones it multiplies by (1 − τγ/2)/(1 + τγ/2). One
/// nonlinear system of D equations a step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Midpoint {
    /// How the implicit equation is solved.
    pub solver: Solver,
}

impl Implicit for Midpoint {
    const ID: &'static str = "midpoint";

    #[inline(always)]
    fn psi<H: Increment>(&self, h: H, start: H::Vector, z: H::Vector) -> H::Vector {
        let middle = (z + start) * 0.5;
        (h.field(middle) - middle * (h.step().tau * h.step().rate_at_middle)) + start
    }

    fn solver(&self) -> Solver {
        self.solver
    }
}
