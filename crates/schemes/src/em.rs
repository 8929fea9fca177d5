//! Euler–Maruyama on the Itô form (paper, §5).
//!
//! y_{n+1} = y_n + τ(B∇H₀ − γ(t_n)y_n + ½Σ fₘ′fₘ) + Σ fₘΔŴₘ, all at y_n, with fₘ = B∇Hₘ.
//!
//! The paper's system is in Stratonovich form; ½Σ fₘ′fₘ, by directional derivatives that include
//! that of B, turns it into the Itô form that this scheme needs. Strong order ½, weak order 1;
//! keeps no invariant. Explicit: M + 1 evaluations of the vector field and M of its derivative a
//! step.

use nonlin::{BlockStatus, Outcome, Solution};
use real::{Block, Kernel, WIDTH, dispatch};
use systems::{PoissonSystem, ito_correction, vector_field};

use crate::{Scheme, Step};

/// Euler–Maruyama on the Itô form, `em`.
#[derive(Clone, Copy, Debug, Default)]
pub struct EulerMaruyama;

/// One step on one path.
#[inline(always)]
fn advance<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    step: &Step,
    dw: [f64; M],
    y: [f64; D],
) -> [f64; D] {
    let field = vector_field(system, y, step.tau, dw);
    let correction = ito_correction(system, y);
    let mut next = y;
    for i in 0..D {
        next[i] = y[i] + (field[i] + step.tau * (correction[i] - step.rate_at_start * y[i]));
    }
    next
}

struct StepKernel<'a, S, const D: usize, const M: usize> {
    system: &'a S,
    step: &'a Step,
    dw: &'a Block<M>,
    y: &'a mut Block<D>,
    status: &'a mut BlockStatus,
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Kernel for StepKernel<'_, S, D, M> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let (dw, mut y) = (*self.dw, *self.y);
        for p in 0..WIDTH {
            y.set_path(p, advance(self.system, self.step, dw.path(p), y.path(p)));
        }
        *self.y = y;
        *self.status = BlockStatus::explicit();
        self.status.fail_where_not_finite(&y);
    }
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Scheme<S, D, M> for EulerMaruyama {
    fn id(&self) -> &'static str {
        "em"
    }

    fn step_block(
        &self,
        system: &S,
        step: &Step,
        dw: &Block<M>,
        y: &mut Block<D>,
        status: &mut BlockStatus,
    ) {
        dispatch(StepKernel { system, step, dw, y, status });
    }

    fn step(&self, system: &S, step: &Step, dw: [f64; M], y: [f64; D]) -> Solution<D> {
        let z = advance(system, step, dw, y);
        Solution { z, outcome: Outcome::Fast { iterations: 1 } }.checked()
    }
}
