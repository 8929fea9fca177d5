//! Euler–Maruyama.

use crate::{Explicit, Increment};

/// The Euler–Maruyama scheme on the Itô form, `em` (Maruyama 1955; Bréhier, Cohen and Komori 2025,
/// §5).
///
/// y_{n+1} = y_n + B∇h + τ(½Σ fₘ′fₘ − γ(t_n)y_n), all at y_n, with h = H₀τ + Σ HₘΔŴₘ and fₘ = B∇Hₘ.
///
/// The term ½Σ fₘ′fₘ converts the Stratonovich equation to the Itô equation. It is computed by
/// directional derivatives, including that of B.
///
/// - Orders: strong ½, weak 1.
/// - Preserves no invariant.
/// - Cost per step: M + 1 evaluations of the vector field and M of its derivative.
#[derive(Clone, Copy, Debug, Default)]
pub struct EulerMaruyama;

impl Explicit for EulerMaruyama {
    const ID: &'static str = "em";

    #[inline(always)]
    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        let step = h.step();
        y + (h.field(y) + (h.ito_correction(y) - y * step.rate_at_start) * step.tau)
    }
}
