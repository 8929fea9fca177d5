//! The stochastic conformal exponential integrator (paper, `confexp` and `split`).
//!
//! For dy = (B∇H₀ − γy)dt + Σ B∇Hₘ ∘ dWₘ (Stratonovich), with h = H₀τ + Σ HₘΔŴₘ:
//!
//! ẑ = e^{−∫γ, first half} y_n,  z = ẑ + B((ẑ+z)/2) ∇̄h(ẑ, z),  y_{n+1} = e^{−∫γ, second half} z.
//!
//! A Strang splitting into exact damping and an energy-preserving step. Strong order ½ for several
//! noises, 1 for one noise (k ≥ 2); weak order 1. Keeps linear and quadratic Casimirs exactly on
//! their damped law for every τ; with one noise, dy = B∇H(dt + c∘dW) − γy dt, also a homogeneous H.
//! Implicit: one nonlinear system of D equations a step.

use nonlin::{BlockStatus, FirstSweep, Method, Solution, Solver};
use real::{Block, Kernel, Real, WIDTH, dispatch};
use systems::PoissonSystem;

use crate::implicit::{BlockNoise, Rule, first_sweep, method, solve_block, solve_path};
use crate::{Scheme, Step};

/// The stochastic conformal exponential integrator, `sexp`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sexp {
    /// How the implicit equation is solved.
    pub solver: Solver,
}

/// B((ẑ+z)/2) ∇̄h(ẑ, z).
#[derive(Clone, Copy)]
pub(crate) struct AveragedField {
    pub(crate) tau: f64,
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Rule<S, [f64; M], D>
    for AveragedField
{
    const METHOD: Method = method::<S, D, M>();
    const FIRST_SWEEP: FirstSweep =
        if S::SOLVES_SHORT_STEPS { FirstSweep::Own } else { first_sweep::<S, D, M>() };

    #[inline(always)]
    fn change<R: Real>(&self, system: &S, dw: [f64; M], start: [f64; D], z: [R; D]) -> [R; D] {
        let mut z_hat = [R::zero(); D];
        for i in 0..D {
            z_hat[i] = R::constant(start[i]);
        }
        system.averaged_field(z_hat, z, self.tau, dw)
    }

    #[inline(always)]
    fn own_sweep(&self, system: &S, dw: [f64; M], start: [f64; D]) -> ([f64; D], f64) {
        system.short_step(start, self.tau, dw)
    }

    #[inline(always)]
    fn own_sweeps(
        &self,
        system: &S,
        dw: [[f64; M]; 2],
        start: [[f64; D]; 2],
    ) -> [([f64; D], f64); 2] {
        system.short_steps(start, self.tau, dw)
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
        let rule = AveragedField { tau: self.step.tau };
        split_block(&self.solver, rule, self.system, self.step, self.dw, self.y, self.status);
    }
}

/// Half the damping, the implicit step of a rule, the other half of the damping, for a block; to be
/// called inside a kernel.
#[inline(always)]
pub(crate) fn split_block<S, Q: Rule<S, B::Path, D>, B: BlockNoise, const D: usize>(
    solver: &Solver,
    rule: Q,
    system: &S,
    step: &Step,
    noise: &B,
    y: &mut Block<D>,
    status: &mut BlockStatus,
) {
    for i in 0..D {
        for p in 0..WIDTH {
            y.0[i][p] *= step.first_decay;
        }
    }
    let z = solve_block(solver, rule, system, noise, y, status);
    for i in 0..D {
        for p in 0..WIDTH {
            y.0[i][p] = step.second_decay * z.0[i][p];
        }
    }
    if may_overflow(step) {
        status.fail_where_not_finite(y);
    }
}

/// The same for one path.
pub(crate) fn split_path<S, Q: Rule<S, N, D>, N: Copy, const D: usize>(
    solver: &Solver,
    rule: Q,
    system: &S,
    step: &Step,
    noise: N,
    y: [f64; D],
) -> Solution<D> {
    let z_hat = y.map(|component| step.first_decay * component);
    let mut solution = solve_path(solver, rule, system, noise, z_hat);
    solution.z = solution.z.map(|component| step.second_decay * component);
    if may_overflow(step) { solution.checked() } else { solution }
}

/// Whether the second half of the damping may take a solution out of the numbers; a NaN may.
#[inline(always)]
fn may_overflow(step: &Step) -> bool {
    step.second_decay > 1.0 || step.second_decay.is_nan()
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Scheme<S, D, M> for Sexp {
    fn id(&self) -> &'static str {
        "sexp"
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
        split_path(&self.solver, AveragedField { tau: step.tau }, system, step, dw, y)
    }
}
