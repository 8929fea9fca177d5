//! Two schemes as a user would write them, on top of the crates.

use schemes::{Explicit, Implicit, Increment};

/// Euler's method with Lévy areas: y_{n+1} = y_n + B∇h + Σ A_ml \[fₘ, f_l\], on noise that is not
/// truncated.
pub struct EulerWithAreas;

impl Explicit for EulerWithAreas {
    const ID: &'static str = "euler-with-areas";
    const READS_AREAS: bool = true;
    const CLIPS_INCREMENTS: bool = false;

    #[inline(always)]
    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        y + h.field(y) + h.commutators(y)
    }
}

/// The midpoint rule with exact damping: ψ(ẑ, z) = ẑ + B(z̄)∇h(z̄), z̄ = (ẑ+z)/2.
pub struct ConformalMidpoint;

impl Implicit for ConformalMidpoint {
    const ID: &'static str = "conformal-midpoint";
    const EXACT_DAMPING: bool = true;

    #[inline(always)]
    fn psi<H: Increment>(&self, h: H, start: H::Vector, z: H::Vector) -> H::Vector {
        start + h.field((start + z) * 0.5)
    }
}
