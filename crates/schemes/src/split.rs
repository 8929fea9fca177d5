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

/// A state that is moved by flows: one path, or rows of numbers.
pub(crate) trait Moved {
    /// Multiplies the state by a number.
    fn scale(&mut self, factor: f64);
    /// The flow of a part over the step, or over half of it.
    fn flow(&mut self, part: usize, half: bool);
}

/// The composition of the flows of `parts` ≥ 1 parts.
#[inline(always)]
pub(crate) fn compose(parts: usize, step: &Step, state: &mut impl Moved) {
    state.scale(step.first_decay);
    for part in 0..parts - 1 {
        state.flow(part, true);
    }
    state.flow(parts - 1, false);
    for part in (0..parts - 1).rev() {
        state.flow(part, true);
    }
    state.scale(step.second_decay);
}

/// One path of a compiled system.
struct Path<'a, S, const D: usize, const M: usize> {
    system: &'a S,
    tau: f64,
    increments: [f64; M],
    y: [f64; D],
}

impl<S: Flows<D, M>, const D: usize, const M: usize> Moved for Path<'_, S, D, M> {
    #[inline(always)]
    fn scale(&mut self, factor: f64) {
        for i in 0..D {
            self.y[i] *= factor;
        }
    }

    #[inline(always)]
    fn flow(&mut self, part: usize, half: bool) {
        let (mut dt, mut dw) = (self.tau, self.increments);
        if half {
            dt *= 0.5;
            for m in 0..M {
                dw[m] *= 0.5;
            }
        }
        self.y = self.system.flow(part, self.y, dt, dw);
    }
}

/// One step of one path.
#[inline(always)]
fn advance<S: Flows<D, M>, const D: usize, const M: usize>(
    system: &S,
    step: &Step,
    increments: [f64; M],
    y: [f64; D],
) -> [f64; D] {
    let mut path = Path { system, tau: step.tau, increments, y };
    compose(S::PARTS, step, &mut path);
    path.y
}

struct SplitKernel<'a, S, const D: usize, const M: usize> {
    system: &'a S,
    step: Step,
    noise: BlockNoise<'a, M>,
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
            let increments = noise.increments_of(p);
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
        dispatch(SplitKernel { system, step: *step, noise: *noise, y, status });
    }

    fn step(&self, system: &S, step: &Step, noise: &Noise<M>, y: [f64; D]) -> Solution<D> {
        let z = advance(system, step, noise.increments, y);
        Solution { z, outcome: Outcome::Fast { iterations: 1 } }.checked()
    }
}
