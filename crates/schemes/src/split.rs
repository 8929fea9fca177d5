//! Exact flows in turn.

use systems::Flows;

use crate::{Composition, Paths, Step, Times};

/// Splitting into exact flows, `split` (Bréhier, Cohen and Jahnke 2023), with exact damping.
///
/// For a system with the parts 0 … P ([`Flows`]), with half of the damping, D, before and after,
///
/// y_{n+1} = D φ₀(½) ⋯ φ_{P−1}(½) φ_P(1) φ_{P−1}(½) ⋯ φ₀(½) D y_n,
///
/// where φ_k(c) is the flow of part k for c·(τ, ΔW). The composition is symmetric: commutators of
/// the parts, which would cost half an order, cancel.
///
/// - Orders: strong 1 for one noise or commuting noises, else ½; weak 1; order 2 without noise.
/// - Preserves the conformal law of every homogeneous Casimir of any degree exactly, for every τ
///   and every increment: none is truncated. It does not preserve an energy.
/// - Cost per step: 2P + 1 flows. Explicit.
#[derive(Clone, Copy, Debug, Default)]
pub struct Split;

impl<S: Flows<D, M>, const D: usize, const M: usize> Composition<S, D, M> for Split {
    const ID: &'static str = "split";

    #[inline(always)]
    fn compose<const N: usize>(&self, step: &Step, paths: &mut Paths<'_, S, D, M, N>) {
        paths.scale(step.first_decay);
        paths.symmetric(Times::step(step));
        paths.scale(step.second_decay);
    }
}
