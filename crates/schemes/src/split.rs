//! Exact flows in turn.

use noise::{BlockNoise, Noise};
use nonlin::{BlockStatus, Outcome, Solution};
use real::{Block, Kernel, WIDTH, dispatch};
use systems::Flows;

use crate::{Scheme, Step};

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

/// One step of one path.
#[inline(always)]
fn advance<S: Flows<D, M>, const D: usize, const M: usize>(
    system: &S,
    step: &Step,
    increments: [f64; M],
    mut y: [f64; D],
) -> [f64; D] {
    let half_tau = 0.5 * step.tau;
    let half = increments.map(|dw| 0.5 * dw);
    for i in 0..D {
        y[i] *= step.first_decay;
    }
    for part in 0..S::PARTS - 1 {
        y = system.flow(part, y, half_tau, half);
    }
    y = system.flow(S::PARTS - 1, y, step.tau, increments);
    for part in (0..S::PARTS - 1).rev() {
        y = system.flow(part, y, half_tau, half);
    }
    for i in 0..D {
        y[i] *= step.second_decay;
    }
    y
}

struct SplitKernel<'a, S, const D: usize, const M: usize> {
    system: &'a S,
    step: Step,
    noise: &'a BlockNoise<M>,
    y: &'a mut Block<D>,
    status: &'a mut BlockStatus,
}

impl<S: Flows<D, M>, const D: usize, const M: usize> Kernel for SplitKernel<'_, S, D, M> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { system, step, noise, y, status } = self;
        let (start, mut next) = (*y, *y);
        for p in 0..WIDTH {
            let increments = noise.increments.path(p);
            next.set_path(p, advance(system, &step, increments, start.path(p)));
        }
        *y = next;
        *status = BlockStatus::explicit();
        status.fail_where_not_finite(&y.0);
    }
}

impl<S: Flows<D, M>, const D: usize, const M: usize> Scheme<S, D, M> for Split {
    fn id(&self) -> &'static str {
        "split"
    }

    fn reads_areas(&self) -> bool {
        false
    }

    fn clips_increments(&self) -> bool {
        false
    }

    fn step_block(
        &self,
        system: &S,
        step: &Step,
        noise: &BlockNoise<M>,
        y: &mut Block<D>,
        status: &mut BlockStatus,
    ) {
        dispatch(SplitKernel { system, step: *step, noise, y, status });
    }

    fn step(&self, system: &S, step: &Step, noise: &Noise<M>, y: [f64; D]) -> Solution<D> {
        let z = advance(system, step, noise.increments, y);
        Solution { z, outcome: Outcome::Fast { iterations: 1 } }.checked()
    }
}
