//! Euler–Maruyama.

use crate::{Explicit, Increment};

/// Euler–Maruyama on the Itô form, `em` (Bréhier, Cohen and Komori 2025, §5).
///
/// y_{n+1} = y_n + B∇h + τ(½Σ fₘ′fₘ − γ(t_n)y_n), all at y_n, with h = H₀τ + Σ HₘΔŴₘ and fₘ = B∇Hₘ.
///
/// The paper's system is in Stratonovich form; ½Σ fₘ′fₘ, by directional derivatives that include
/// that of B, turns it into the Itô form that this scheme needs. Strong order ½, weak order 1; keeps
/// no invariant. M + 1 evaluations of the vector field and M of its derivative a step.
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
