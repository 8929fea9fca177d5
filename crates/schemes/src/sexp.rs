//! The stochastic conformal exponential integrator (paper, `confexp` and `split`).
//!
//! For dy = (B∇H₀ − γy)dt + Σ B∇Hₘ ∘ dWₘ (Stratonovich), with h = H₀τ + Σ HₘΔŴₘ:
//!
//! ẑ = e^{−∫γ, first half} y_n,  z = ẑ + B((ẑ+z)/2) ∇̄h(ẑ, z),  y_{n+1} = e^{−∫γ, second half} z.
//!
//! A Strang splitting into exact damping and an energy-preserving step. Strong order ½ for several noises, 1 for one
//! noise (k ≥ 2); weak order 1. Keeps linear and quadratic Casimirs exactly on their damped law for every τ; with one
//! noise, dy = B∇H(dt + c∘dW) − γy dt, also a homogeneous H. Implicit: one nonlinear system of D equations a step.

use nonlin::{BlockStatus, Solution, Solver};
use real::{Block, Kernel, Real, WIDTH, dispatch};
use systems::PoissonSystem;

use crate::implicit::{Rule, solve_block, solve_path};
use crate::{Scheme, Step};

/// The stochastic conformal exponential integrator, `sexp`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sexp {
    /// How the implicit equation is solved.
    pub solver: Solver,
}

/// B((ẑ+z)/2) ∇̄h(ẑ, z).
#[derive(Clone, Copy)]
struct AveragedField {
    tau: f64,
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Rule<S, D, M> for AveragedField {
    #[inline(always)]
    fn change<R: Real>(&self, system: &S, dw: [f64; M], start: [f64; D], z: [R; D]) -> [R; D] {
        let mut z_hat = [R::zero(); D];
        for i in 0..D {
            z_hat[i] = R::constant(start[i]);
        }
        system.averaged_field(z_hat, z, self.tau, dw)
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
        let mut z_hat = Block::zero();
        for i in 0..D {
            for p in 0..WIDTH {
                z_hat.0[i][p] = self.step.first_decay * self.y.0[i][p];
            }
        }
        let rule = AveragedField { tau: self.step.tau };
        let z = solve_block(&self.solver, rule, self.system, self.dw, &z_hat, self.status);
        for i in 0..D {
            for p in 0..WIDTH {
                self.y.0[i][p] = self.step.second_decay * z.0[i][p];
            }
        }
    }
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Scheme<S, D, M> for Sexp {
    fn id(&self) -> &'static str {
        "sexp"
    }

    fn step_block(&self, system: &S, step: &Step, dw: &Block<M>, y: &mut Block<D>, status: &mut BlockStatus) {
        dispatch(StepKernel { solver: self.solver, system, step, dw, y, status });
    }

    fn step(&self, system: &S, step: &Step, dw: [f64; M], y: [f64; D]) -> Solution<D> {
        let z_hat = y.map(|component| step.first_decay * component);
        let mut solution = solve_path(&self.solver, AveragedField { tau: step.tau }, system, dw, z_hat);
        solution.z = solution.z.map(|component| step.second_decay * component);
        solution
    }
}
