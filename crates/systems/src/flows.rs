//! Systems that are a sum of parts with exact flows.

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
pub trait Flows<const D: usize, const M: usize>: PoissonSystem<D, M> {
    /// The number of parts, at least one.
    const PARTS: usize;

    /// The flow of part number `part` < [`PARTS`](Self::PARTS) for h⁽ᵏ⁾(·; dt, dw), from y.
    fn flow(&self, part: usize, y: [f64; D], dt: f64, dw: [f64; M]) -> [f64; D];
}
