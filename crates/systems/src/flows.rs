//! Systems that are a sum of parts with exact flows.

use real::Real;

use crate::PoissonSystem;

/// A system whose Hamiltonian increment is a sum of parts, h = Σ h⁽ᵏ⁾, each with a flow that is
/// known: y ↦ the solution at time one of ẏ = B(y)∇h⁽ᵏ⁾(y; dt, dw).
///
/// A flow keeps every Casimir of any form, whatever dt and dw are, and so does a composition of
/// flows. Drift and noise of one part share a flow: h⁽ᵏ⁾ = H·(c₀dt + Σ cₘdwₘ) is the flow of H for
/// that time. A map that keeps all Casimirs and agrees with the flow up to third order in (dt, dw)
/// will do as well, such as a rotation by Cayley's map.
///
/// Mark the implementation `#[inline(always)]` and avoid branches, so that blocks are vectorised.
/// Flows are generic over [`Real`], whose sines and exponentials have the same bits on every
/// machine; those of `f64` are the platform's, and are not vectorised.
pub trait Flows<const D: usize, const M: usize>: PoissonSystem<D, M> {
    /// The number of parts, at least one.
    const PARTS: usize;

    /// For each noise m the part that has all of Hₘ, so that the flow of Hₘ is that of this part;
    /// `None` where Hₘ is spread over several parts, as it is unless overridden.
    const NOISE_PARTS: [Option<usize>; M] = [None; M];

    /// Whether part number `part` < [`PARTS`](Self::PARTS) has a part of H₀: if not, its flow
    /// without noise is the identity.
    #[inline(always)]
    fn drifts(&self, _part: usize) -> bool {
        true
    }

    /// The flow of part number `part` < [`PARTS`](Self::PARTS) for h⁽ᵏ⁾(·; dt, dw), from y. The
    /// flow for −dt and −dw must be its inverse.
    fn flow<R: Real>(&self, part: usize, y: [R; D], dt: R, dw: [R; M]) -> [R; D];

    /// Whether [`flow`](Self::flow) is exact up to rounding.
    const EXACT: bool = false;

    /// Flow of a part with an error of fifth order in (dt, dw) at most, as schemes of weak order
    /// two need; by a triple jump of [`flow`](Self::flow) if that is not [exact](Self::EXACT).
    /// Override it where a map of higher order costs less.
    #[inline(always)]
    fn precise_flow<R: Real>(&self, part: usize, y: [R; D], dt: R, dw: [R; M]) -> [R; D] {
        if Self::EXACT {
            return self.flow(part, y, dt, dw);
        }
        let mut z = y;
        for share in TRIPLE_JUMP {
            let mut part_dw = dw;
            for m in 0..M {
                part_dw[m] = part_dw[m] * share;
            }
            z = self.flow(part, z, dt * share, part_dw);
        }
        z
    }
}

/// The shares c, 1 − 2c, c with c = 1/(2 − 2^{1/3}) of three steps in a row, each symmetric and of
/// order two, that have order four together (Yoshida, *Phys. Lett. A* 150, 1990).
pub const TRIPLE_JUMP: [f64; 3] =
    [1.351_207_191_959_657_8, -1.702_414_383_919_315_5, 1.351_207_191_959_657_8];
