//! The stochastic midpoint rule (paper, §5; Milstein, Repin and Tretyakov 2002).
//!
//! y_{n+1} = y_n + B(m)∇h(m) − τγ(t_{n+½})m, m = (y_n + y_{n+1})/2, h = H₀τ + Σ HₘΔŴₘ
//! (Stratonovich).
//!
//! Strong order ½ for several noises, 1 for one; weak order 1. Keeps quadratic Casimirs where γ =
//! 0; with damping it takes 2τγC(m) from them, which depends on the path, instead of multiplying
//! them by e^{−2∫γ}, and multiplies linear ones by (1 − τγ/2)/(1 + τγ/2). Implicit: one nonlinear
//! system of D equations a step.

use nonlin::{BlockStatus, FirstSweep, Method, Solution, Solver};
use real::{Block, Kernel, Real, dispatch};
use systems::{PoissonSystem, vector_field};

use crate::implicit::{Rule, first_sweep, method, solve_block, solve_path};
use crate::{Scheme, Step};

/// The stochastic midpoint rule, `midpoint`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Midpoint {
    /// How the implicit equation is solved.
    pub solver: Solver,
}

/// B(m)∇h(m) − τγm at the midpoint m.
#[derive(Clone, Copy)]
struct MidpointField {
    tau: f64,
    /// τγ(t_{n+½}).
    damping: f64,
}

impl MidpointField {
    fn new(step: &Step) -> Self {
        Self { tau: step.tau, damping: step.tau * step.rate_at_middle }
    }
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Rule<S, [f64; M], D>
    for MidpointField
{
    const METHOD: Method = method::<S, D, M>();
    const FIRST_SWEEP: FirstSweep = first_sweep::<S, D, M>();

    #[inline(always)]
    fn change<R: Real>(&self, system: &S, dw: [f64; M], start: [f64; D], z: [R; D]) -> [R; D] {
        let mut middle = [R::zero(); D];
        for i in 0..D {
            middle[i] = (z[i] + start[i]) * 0.5;
        }
        let mut change = vector_field(system, middle, self.tau, dw);
        for i in 0..D {
            change[i] = change[i] - middle[i] * self.damping;
        }
        change
    }
}

struct StepKernel<'a, S, const D: usize, const M: usize> {
    solver: Solver,
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
        let start = *self.y;
        let rule = MidpointField::new(self.step);
        *self.y = solve_block(&self.solver, rule, self.system, self.dw, &start, self.status);
    }
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Scheme<S, D, M> for Midpoint {
    fn id(&self) -> &'static str {
        "midpoint"
    }

    fn step_block(
        &self,
        system: &S,
        step: &Step,
        dw: &Block<M>,
        y: &mut Block<D>,
        status: &mut BlockStatus,
    ) {
        dispatch(StepKernel { solver: self.solver, system, step, dw, y, status });
    }

    fn step(&self, system: &S, step: &Step, dw: [f64; M], y: [f64; D]) -> Solution<D> {
        solve_path(&self.solver, MidpointField::new(step), system, dw, y)
    }
}
