//! The stochastic Heun method.

use crate::{Explicit, Increment};

/// The stochastic Heun method, `heun` (Rümelin 1982; Kloeden and Platen 1992, §15.2).
///
/// With F(t, y) = B(y)∇h(y) − τγ(t)y and h = H₀τ + Σ HₘΔŴₘ:
///
/// ỹ = y_n + F(t_n, y_n),  y_{n+1} = y_n + ½(F(t_n, y_n) + F(t_{n+1}, ỹ)).
///
/// The average of the fields at both ends makes it consistent with the Stratonovich equation; no
/// derivative of a field is needed. Strong order 1 for one noise or noises that commute, ½
/// otherwise; weak order 1; order 2 without noise. Keeps no invariant: it is here as the explicit
/// scheme that an implicit one has to beat. Two evaluations of the vector field a step.
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
