//! The stochastic conformal exponential integrator.

use nonlin::Solver;

use crate::{Implicit, Increment};

/// The stochastic conformal exponential integrator, `sexp` (Bréhier, Cohen and Komori 2025).
///
/// For dy = (B∇H₀ − γy)dt + Σ B∇Hₘ ∘ dWₘ (Stratonovich), with h = H₀τ + Σ HₘΔŴₘ:
///
/// ẑ = e^{−∫γ, first half} y_n,  z = ẑ + B((ẑ+z)/2) ∇̄h(ẑ, z),  y_{n+1} = e^{−∫γ, second half} z.
///
/// A Strang splitting into exact damping and an energy-preserving step. Strong order 1 for one
/// noise or noises that commute, ½ otherwise (truncation order k ≥ 2); weak order 1. Keeps linear
/// and quadratic Casimirs exactly on their damped law for every τ; with one noise,
/// dy = B∇H(dt + c∘dW) − γy dt, also a homogeneous H. One nonlinear system of D equations a step.
/// Take it where an invariant matters, or where large steps must stay bounded.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sexp {
    /// How the implicit equation is solved.
    pub solver: Solver,
}

impl Implicit for Sexp {
    const ID: &'static str = "sexp";
    const EXACT_DAMPING: bool = true;
    const PREDICTED: bool = true;

    #[inline(always)]
    fn psi<H: Increment>(&self, h: H, start: H::Vector, z: H::Vector) -> H::Vector {
        h.averaged_field(start, z) + start
    }

    fn solver(&self) -> Solver {
        self.solver
    }
}
