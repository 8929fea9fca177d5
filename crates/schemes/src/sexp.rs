//! The stochastic conformal exponential integrator.

use crate::{Implicit, Increment};

/// The stochastic conformal exponential integrator, `sexp` (Bréhier, Cohen and Komori 2025).
///
/// For dy = (B∇H₀ − γy)dt + Σ B∇Hₘ ∘ dWₘ (Stratonovich), with h = H₀τ + Σ HₘΔŴₘ:
///
/// ẑ = e^{−∫γ, first half} y_n,  z = ẑ + B((ẑ+z)/2) ∇̄h(ẑ, z),  y_{n+1} = e^{−∫γ, second half} z.
///
/// This is a Strang splitting into exact damping and an energy-preserving step.
///
/// - Orders: strong 1 for one noise or commuting noises, else ½ (truncation order k ≥ 2); weak 1.
/// - Preserves the conformal law of linear and quadratic Casimirs exactly for every τ. With one
///   noise, dy = B∇H(dt + c∘dW) − γy dt, it also preserves that of a homogeneous H.
/// - Cost per step: one nonlinear system of D equations.
///
/// Use it if an invariant matters, or if large steps must stay bounded.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sexp;

impl Implicit for Sexp {
    const ID: &'static str = "sexp";
    const EXACT_DAMPING: bool = true;
    const PREDICTED: bool = true;

    #[inline(always)]
    fn psi<H: Increment>(&self, h: H, start: H::Vector, z: H::Vector) -> H::Vector {
        h.averaged_field(start, z) + start
    }
}
