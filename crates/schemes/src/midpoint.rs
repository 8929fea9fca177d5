//! The stochastic midpoint rule (paper, §5; Milstein, Repin and Tretyakov 2002).
//!
//! y_{n+1} = y_n + B(m)∇h(m) − τγ(t_{n+½})m,  m = (y_n + y_{n+1})/2,  h = H₀τ + Σ HₘΔŴₘ (Stratonovich).
//!
//! Strong order ½ for several noises, 1 for one; weak order 1. Keeps quadratic Casimirs where γ = 0; with damping it
//! takes 2τγC(m) from them, which depends on the path, instead of multiplying them by e^{−2∫γ}, and multiplies linear
//! ones by (1 − τγ/2)/(1 + τγ/2). Implicit: one nonlinear system of D equations a step.

use nonlin::{BlockFixedPoint, BlockStatus, FixedPoint, Solution, Solver};
use real::{Block, Kernel, Real, dispatch};
use systems::{PoissonSystem, vector_field};

use crate::{Scheme, Step};

/// The stochastic midpoint rule, `midpoint`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Midpoint {
    /// How the implicit equation is solved.
    pub solver: Solver,
}

struct PathEquation<'a, S, const D: usize, const M: usize> {
    system: &'a S,
    tau: f64,
    damping: f64,
    dw: [f64; M],
    y: [f64; D],
}

impl<S, const D: usize, const M: usize> Clone for PathEquation<'_, S, D, M> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}
impl<S, const D: usize, const M: usize> Copy for PathEquation<'_, S, D, M> {}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> FixedPoint<D> for PathEquation<'_, S, D, M> {
    #[inline(always)]
    fn start(&self) -> [f64; D] {
        self.y
    }

    #[inline(always)]
    fn map<R: Real>(&self, z: [R; D]) -> [R; D] {
        let mut middle = [R::zero(); D];
        for i in 0..D {
            middle[i] = (z[i] + self.y[i]) * 0.5;
        }
        let mut next = vector_field(self.system, middle, self.tau, self.dw);
        for i in 0..D {
            next[i] = (next[i] - middle[i] * self.damping) + self.y[i];
        }
        next
    }
}

struct BlockEquation<'a, S, const D: usize, const M: usize> {
    system: &'a S,
    tau: f64,
    damping: f64,
    dw: &'a Block<M>,
    y: &'a Block<D>,
}

impl<'a, S: PoissonSystem<D, M>, const D: usize, const M: usize> BlockFixedPoint<D> for BlockEquation<'a, S, D, M> {
    type Path = PathEquation<'a, S, D, M>;
    #[inline(always)]
    fn path(&self, p: usize) -> Self::Path {
        PathEquation {
            system: self.system,
            tau: self.tau,
            damping: self.damping,
            dw: self.dw.path(p),
            y: self.y.path(p),
        }
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
        let equations = BlockEquation {
            system: self.system,
            tau: self.step.tau,
            damping: self.step.tau * self.step.rate_at_middle,
            dw: self.dw,
            y: self.y,
        };
        let mut z = Block::zero();
        self.solver.solve_block(&equations, &mut z, self.status);
        *self.y = z;
    }
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Scheme<S, D, M> for Midpoint {
    fn id(&self) -> &'static str {
        "midpoint"
    }

    fn step_block(&self, system: &S, step: &Step, dw: &Block<M>, y: &mut Block<D>, status: &mut BlockStatus) {
        dispatch(StepKernel { solver: self.solver, system, step, dw, y, status });
    }

    fn step(&self, system: &S, step: &Step, dw: [f64; M], y: [f64; D]) -> Solution<D> {
        let damping = step.tau * step.rate_at_middle;
        self.solver.solve(&PathEquation { system, tau: step.tau, damping, dw, y })
    }
}
