//! The stochastic Heun method with Lévy areas.

use crate::{Explicit, Heun, Increment};

/// The stochastic Heun method with Lévy areas, `heun-levy`: strong order 1 for any noises.
///
/// y_{n+1} is that of [`Heun`] plus Σ_{m<l} Â_ml \[fₘ, f_l\](y_n) with the truncated Lévy areas
/// Â_ml of the step and [f, g] = g′f − f′g: the skew part of the term Σ f_l′fₘ J_ml of the
/// Stratonovich–Taylor expansion (Kloeden and Platen 1992, §5.5), whose symmetric part is in
/// [`Heun`].
///
/// - Orders: strong 1, weak 1; order 2 without noise.
/// - Preserves no invariant.
/// - Cost per step: two evaluations of the vector field, the commutators, and the Lévy areas.
///   Without `AREAS`, for noises that commute, a step is one of [`Heun`].
#[derive(Clone, Copy, Debug, Default)]
pub struct HeunLevy<const AREAS: bool>;

impl<const AREAS: bool> Explicit for HeunLevy<AREAS> {
    const ID: &'static str = "heun-levy";
    const READS_AREAS: bool = AREAS;

    #[inline(always)]
    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        let next = Heun.advance(h, y);
        if AREAS { next + h.commutators(y) } else { next }
    }
}
