//! Weak order two: flows of the Hamiltonians, one by one.

use real::unrolled;
use systems::Flows;

use crate::{Composition, Paths, Scheme, Step, Times};

/// The scheme of Ninomiya and Victoir (*Appl. Math. Finance* 15, 2008) with Poisson flows and exact
/// damping, `nv`.
///
/// With the flow P₀ of H₀ for half a step, the flows Pₘ of Hₘ for the time ΔWₘ, and the two halves
/// of the damping, D,
///
/// y_{n+1} = P₀ D P_M ⋯ P₁ D P₀ y_n  or  P₀ D P₁ ⋯ P_M D P₀ y_n,
///
/// in turn, see [`Sweep`]. The error terms of order τ of the two orders of the noises are opposite,
/// and cancel over two steps: no coin is needed. (Over whole paths they cancel in the mean of both
/// as well.) For an even number of steps the expectation has an expansion in even powers of τ, up
/// to what flows that are not exact add.
///
/// - Orders: weak 2; strong 1 for one noise or commuting noises, else ½; order 2 without noise.
/// - Preserves the conformal law of every homogeneous Casimir that its flows preserve, for every τ
///   and every increment: none is truncated. It does not preserve an energy.
/// - Flows: those of the parts of a system ([`Flows`]). H₀ is composed symmetrically, with an error
///   of second order. A noise whose Hamiltonian is in one part has the
///   [precise flow](Flows::precise_flow) of that part; of others a symmetric composition makes a
///   triple jump.
/// - Cost per step: M + 2 flows. Explicit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Nv {
    /// The order of the noises.
    pub sweep: Sweep,
}

/// Order in which the noises of a step follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Sweep {
    /// First to last in even steps, last to first in odd ones.
    #[default]
    Alternating,
    /// First to last in every step. Of weak order one alone.
    Forward,
    /// Last to first in every step. The mean of a function over this and [`Forward`](Self::Forward)
    /// with the same increments is of weak order two.
    Backward,
}

impl Sweep {
    /// Whether the noises of a step go from last to first.
    fn is_backward(self, step: &Step) -> bool {
        match self {
            Self::Alternating => step.number() % 2 == 1,
            Self::Forward => false,
            Self::Backward => true,
        }
    }
}

impl<S: Flows<D, M>, const D: usize, const M: usize> Composition<S, D, M> for Nv {
    const ID: &'static str = "nv";

    #[inline(always)]
    fn compose<const N: usize>(&self, step: &Step, paths: &mut Paths<'_, S, D, M, N>) {
        let half = Times::drift(0.5 * step.tau);
        paths.symmetric(half);
        paths.scale(step.first_decay);
        // Numbers of noises are constants, so that each loop over paths has one flow.
        if M > 1 && self.sweep.is_backward(step) {
            unrolled!(f64: k in 0..M => { paths.noise(M - 1 - k, Times::noise(M - 1 - k)); });
        } else {
            unrolled!(f64: m in 0..M => { paths.noise(m, Times::noise(m)); });
        }
        paths.scale(step.second_decay);
        paths.symmetric(half);
    }

    fn both_orders(&self) -> Option<[Box<dyn Scheme<S, D, M>>; 2]> {
        Some([Sweep::Forward, Sweep::Backward].map(|sweep| Box::new(Self { sweep }) as _))
    }
}
