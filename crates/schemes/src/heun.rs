//! The stochastic Heun method.

use crate::{Explicit, Increment};

/// The stochastic Heun method, `heun` (Rümelin 1982; Kloeden and Platen 1992, §15.2).
///
/// With F(t, y) = B(y)∇h(y) − τγ(t)y and h = H₀τ + Σ HₘΔŴₘ:
///
/// ỹ = y_n + F(t_n, y_n),  y_{n+1} = y_n + ½(F(t_n, y_n) + F(t_{n+1}, ỹ)).
///
/// The average of the fields at both ends makes the scheme consistent with the Stratonovich
/// equation, without derivatives of the fields.
///
/// - Orders: strong 1 for one noise or commuting noises, else ½; weak 1; order 2 without noise.
/// - Preserves no invariant. It is the explicit scheme to compare implicit ones with.
/// - Cost per step: two evaluations of the vector field.
#[derive(Clone, Copy, Debug, Default)]
pub struct Heun;

impl Explicit for Heun {
    const ID: &'static str = "heun";

    #[inline(always)]
    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        let step = h.step();
        let first = h.field(y) - y * (step.tau * step.rate_at_start);
        let predicted = y + first;
        let second = h.field(predicted) - predicted * (step.tau * step.rate_at_end);
        y + (first + second) * 0.5
    }
}
