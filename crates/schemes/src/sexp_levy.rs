//! The conformal exponential integrator with Lévy areas: strong order one for any number of noises.
//!
//! With ẑ = e^{−∫γ, first half} y_n, z̄ = (ẑ+z)/2 and the Lévy areas A_ml of the step,
//!
//! z = ẑ + B(z̄) ∇̄h(ẑ, z) + Σ_{m<l} Â_ml \[fₘ, f_l\](z̄),  y_{n+1} = e^{−∫γ, second half} z,
//!
//! where fₘ = B∇Hₘ and [f, g] = g′f − f′g. The sum is what the Stratonovich–Taylor expansion of
//! order one has and the step of [`Sexp`](crate::Sexp) lacks: Σ f_l′fₘ J_ml with J = ½ΔWΔWᵀ + A, of
//! which the symmetric half is in the averaged gradient already. It is tangent to the level sets of
//! every Casimir C, since [fₘ, f_l]C = fₘ(f_l C) − f_l(fₘ C) = 0 at every point, Jacobi's identity
//! or not; so linear and quadratic Casimirs keep their damped law exactly, as with `Sexp`. A
//! homogeneous energy is kept with one noise, where there is no area. Areas are truncated like
//! increments, so that the equation stays solvable ([`noise::Truncation::area_bound`]).

use noise::AreaBlock;
use nonlin::{BlockStatus, FirstSweep, Method, Solution, Solver};
use real::{Block, Kernel, Real, dispatch};
use systems::{PoissonSystem, noises_commute};

use crate::implicit::{BlockWithAreas, Rule, WithAreas, first_sweep, method};
use crate::sexp::{AveragedField, split_block, split_path};
use crate::{Scheme, Sexp, Step};

/// The conformal exponential integrator with Lévy areas, `sexp-levy`.
#[derive(Clone, Copy, Debug)]
pub struct SexpLevy {
    /// How the implicit equation is solved.
    pub solver: Solver,
    commuting: bool,
}

impl SexpLevy {
    /// The scheme for a system: where the noises commute around `y0` no areas are asked for, and a
    /// step is one of [`Sexp`] and costs as much.
    #[must_use]
    pub fn new<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
        system: &S,
        y0: [f64; D],
    ) -> Self {
        Self { solver: Solver::default(), commuting: noises_commute(system, y0) }
    }

    /// Whether the noises were found to commute.
    #[must_use]
    pub fn commuting(&self) -> bool {
        self.commuting
    }
}

/// B(z̄) ∇̄h(ẑ, z) + Σ A_ml \[fₘ, f_l\](z̄).
#[derive(Clone, Copy)]
struct FieldWithAreas {
    averaged: AveragedField,
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Rule<S, WithAreas<M>, D>
    for FieldWithAreas
{
    const METHOD: Method = method::<S, D, M>();
    const FIRST_SWEEP: FirstSweep = first_sweep::<S, D, M>();

    #[inline(always)]
    fn change<R: Real>(
        &self,
        system: &S,
        noise: WithAreas<M>,
        start: [f64; D],
        z: [R; D],
    ) -> [R; D] {
        let mut change = self.averaged.change(system, noise.dw, start, z);
        let mut middle = [R::zero(); D];
        for i in 0..D {
            middle[i] = (z[i] + start[i]) * 0.5;
        }
        let commutators = system.commutators(middle, noise.areas);
        for i in 0..D {
            change[i] = change[i] + commutators[i];
        }
        change
    }
}

struct StepKernel<'a, S, const D: usize, const M: usize> {
    solver: Solver,
    system: &'a S,
    step: &'a Step,
    noise: BlockWithAreas<'a, M>,
    y: &'a mut Block<D>,
    status: &'a mut BlockStatus,
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Kernel for StepKernel<'_, S, D, M> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let rule = FieldWithAreas { averaged: AveragedField { tau: self.step.tau } };
        split_block(&self.solver, rule, self.system, self.step, &self.noise, self.y, self.status);
    }
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Scheme<S, D, M> for SexpLevy {
    fn id(&self) -> &'static str {
        "sexp-levy"
    }

    fn needs_areas(&self) -> bool {
        M > 1 && !self.commuting
    }

    /// A step of [`Sexp`]: zero is the mean of the areas given the increments.
    fn step_block(
        &self,
        system: &S,
        step: &Step,
        dw: &Block<M>,
        y: &mut Block<D>,
        status: &mut BlockStatus,
    ) {
        Sexp { solver: self.solver }.step_block(system, step, dw, y, status);
    }

    /// A step of [`Sexp`]: zero is the mean of the areas given the increments.
    fn step(&self, system: &S, step: &Step, dw: [f64; M], y: [f64; D]) -> Solution<D> {
        Sexp { solver: self.solver }.step(system, step, dw, y)
    }

    fn step_block_with_areas(
        &self,
        system: &S,
        step: &Step,
        dw: &Block<M>,
        areas: &AreaBlock<M>,
        y: &mut Block<D>,
        status: &mut BlockStatus,
    ) {
        if Scheme::<S, D, M>::needs_areas(self) {
            dispatch(StepKernel {
                solver: self.solver,
                system,
                step,
                noise: BlockWithAreas { dw, areas },
                y,
                status,
            });
        } else {
            self.step_block(system, step, dw, y, status);
        }
    }

    fn step_with_areas(
        &self,
        system: &S,
        step: &Step,
        dw: [f64; M],
        areas: [[f64; M]; M],
        y: [f64; D],
    ) -> Solution<D> {
        if Scheme::<S, D, M>::needs_areas(self) {
            let rule = FieldWithAreas { averaged: AveragedField { tau: step.tau } };
            split_path(&self.solver, rule, system, step, WithAreas { dw, areas }, y)
        } else {
            self.step(system, step, dw, y)
        }
    }
}
