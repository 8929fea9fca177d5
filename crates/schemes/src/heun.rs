//! The stochastic Heun method on the Stratonovich form (Rümelin 1982; Kloeden and Platen 1992,
//! §15.2).
//!
//! With Fₙ(y) = B(y)∇h(y) − τγ(t_n)y and h = H₀τ + Σ HₘΔŴₘ:
//!
//! ỹ = y_n + Fₙ(y_n), y_{n+1} = y_n + ½(Fₙ(y_n) + Fₙ₊₁(ỹ)), the damping of Fₙ₊₁ taken at t_{n+1}
//! with the increments of the same step.
//!
//! The average of the fields at both ends makes it consistent with the Stratonovich equation, so
//! that no derivative of a field is needed. Strong order 1 for one noise or noises that commute, ½
//! otherwise; weak order 1; order two without noise. Keeps no invariant: it is here as the explicit
//! scheme that an implicit one has to beat. Explicit: two evaluations of the vector field a step.

use nonlin::{BlockStatus, Outcome, Solution};
use real::{Block, Kernel, WIDTH, dispatch};
use systems::{PoissonSystem, vector_field};

use crate::{Scheme, Step};

/// The stochastic Heun method, `heun`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Heun;

/// B(y)∇h(y) − τγy, where `damping` is τγ.
#[inline(always)]
fn change<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    step: &Step,
    damping: f64,
    dw: [f64; M],
    y: [f64; D],
) -> [f64; D] {
    let mut change = vector_field(system, y, step.tau, dw);
    for i in 0..D {
        change[i] -= damping * y[i];
    }
    change
}

/// One step on one path.
#[inline(always)]
fn advance<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    step: &Step,
    dw: [f64; M],
    y: [f64; D],
) -> [f64; D] {
    let first = change(system, step, step.tau * step.rate_at_start, dw, y);
    let mut predicted = y;
    for i in 0..D {
        predicted[i] = y[i] + first[i];
    }
    let second = change(system, step, step.tau * step.rate_at_end, dw, predicted);
    let mut next = y;
    for i in 0..D {
        next[i] = y[i] + 0.5 * (first[i] + second[i]);
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

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Scheme<S, D, M> for Heun {
    fn id(&self) -> &'static str {
        "heun"
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
