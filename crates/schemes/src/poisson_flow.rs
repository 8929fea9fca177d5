//! A flow of order four for any Hamiltonian increment.

use systems::TRIPLE_JUMP;

use crate::{Explicit, Increment};

/// The flow of ẏ = B(y)∇h(y) for time one up to fifth order in h, without damping.
///
/// Where B is affine (`AFFINE`), by the commutator-free method of Celledoni, Marthinsen and Owren
/// (*Future Gener. Comput. Syst.* 19, 2003) with four gradients and two frozen flows ẏ = B(y)v.
/// These are triple jumps of Cayley's map, so every quadratic Casimir is kept for every h. Frozen
/// flows inside of the stages are Taylor polynomials of third order.
///
/// Otherwise by the classical method of Runge and Kutta, which keeps linear Casimirs.
pub(crate) struct PoissonFlow<const AFFINE: bool>;

impl<const AFFINE: bool> Explicit for PoissonFlow<AFFINE> {
    const ID: &'static str = "flow";
    const CLIPS_INCREMENTS: bool = false;

    #[inline(always)]
    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        if !AFFINE {
            let first = h.field(y);
            let second = h.field(y + first * 0.5);
            let third = h.field(y + second * 0.5);
            let fourth = h.field(y + third);
            return y + (first + (second + third) * 2.0 + fourth) * (1.0 / 6.0);
        }
        let first = h.gradient(y);
        let start = frozen(h, y, first * 0.5);
        let second = h.gradient(start);
        let third = h.gradient(frozen(h, y, second * 0.5));
        let fourth = h.gradient(frozen(h, start, third - first * 0.5));
        let middle = (second + third) * (1.0 / 6.0);
        let z = turned(h, y, first * 0.25 + middle - fourth * (1.0 / 12.0));
        turned(h, z, fourth * 0.25 + middle - first * (1.0 / 12.0))
    }
}

/// The solution of ẏ = B(y)v at time one up to third order in v. With A(x) = B(y+x)v − B(y)v the
/// terms are x₁ = B(y)v, x₂ = A(x₁) and x₃ = A(x₂).
#[inline(always)]
fn frozen<H: Increment>(h: H, y: H::Vector, v: H::Vector) -> H::Vector {
    let first = h.structure(y, v);
    let second = h.structure(y + first, v) - first;
    let third = h.structure(y + second, v) - first;
    y + first + second * 0.5 + third * (1.0 / 6.0)
}

/// The same up to fourth order, for which every quadratic Casimir is kept.
#[inline(always)]
fn turned<H: Increment>(h: H, y: H::Vector, v: H::Vector) -> H::Vector {
    let z = h.cayley(y, v * TRIPLE_JUMP[0]);
    let z = h.cayley(z, v * TRIPLE_JUMP[1]);
    h.cayley(z, v * TRIPLE_JUMP[2])
}
