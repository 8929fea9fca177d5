//! The stochastic midpoint rule.

use crate::{Implicit, Increment};

/// The stochastic midpoint rule, `midpoint` (Milstein, Repin and Tretyakov 2002).
///
/// y_{n+1} = y_n + B(ȳ)∇h(ȳ) − τγ(t_{n+½})ȳ,  ȳ = (y_n + y_{n+1})/2,  h = H₀τ + Σ HₘΔŴₘ.
///
/// - Orders: strong 1 for one noise or commuting noises, else ½; weak 1.
/// - Preserves linear and quadratic Casimirs if γ = 0. With damping a quadratic Casimir C changes
///   by −2τγC(ȳ) per step, which depends on the path, instead of the factor e^{−2∫γ}. A linear one
///   is multiplied by (1 − τγ/2)/(1 + τγ/2).
/// - Cost per step: one nonlinear system of D equations.
#[derive(Clone, Copy, Debug, Default)]
pub struct Midpoint;

impl Implicit for Midpoint {
    const ID: &'static str = "midpoint";

    #[inline(always)]
    fn psi<H: Increment>(&self, h: H, start: H::Vector, z: H::Vector) -> H::Vector {
        let middle = (z + start) * 0.5;
        (h.field(middle) - middle * (h.step().tau * h.step().rate_at_middle)) + start
    }
}
