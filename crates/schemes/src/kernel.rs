//! The kernel that advances any formula on any system, on one path and on a block of 32.

use std::marker::PhantomData;

use noise::{BlockNoise, Noise, skew};
use nonlin::{
    BlockFixedPoint, BlockStatus, FirstSweep, FixedPoint, Method, Outcome, Solution, Solver,
};
use real::{Block, Kernel, Real, Row, WIDTH, dispatch, path};
use systems::{ImplicitStep, PoissonSystem};

use crate::{
    About, Implicit, Scheme, Step,
    increment::{SystemIncrement, constant},
};

impl<F, S, const D: usize, const M: usize> Scheme<S, D, M> for F
where
    F: Implicit,
    S: PoissonSystem<D, M>,
{
    fn about(&self) -> About {
        About { reads_areas: M > 1 && F::READS_AREAS, ..about::<F>() }
    }

    fn step_block(
        &self,
        system: &S,
        step: &Step,
        noise: &BlockNoise<M>,
        y: &mut Block<D>,
        status: &mut BlockStatus,
    ) {
        dispatch(StepKernel { formula: self, system, step, noise: *noise, y, status });
    }

    fn step(&self, system: &S, step: &Step, noise: &Noise<M>, y: [f64; D]) -> Solution<D> {
        let start = if F::EXACT_DAMPING { scaled(y, step.first_decay) } else { y };
        let equation = Equation { formula: self, system, step: *step, noise: *noise, start };
        if F::EXPLICIT {
            let z = equation.map(start);
            return Solution { z, outcome: Outcome::Fast { iterations: 1 } }.checked();
        }
        let mut solution = if const { F::SOLVER.is_none() } {
            nonlin::solve(&equation)
        } else {
            solver(self).solve(&equation)
        };
        if F::EXACT_DAMPING {
            solution.z = scaled(solution.z, step.second_decay);
            if may_overflow(step) {
                return solution.checked();
            }
        }
        solution
    }
}

/// Options for solving the equation of a formula.
pub fn solver<F: Implicit>(formula: &F) -> Solver {
    F::SOLVER.map_or_else(Solver::default, |of| of(formula))
}

/// Identifier and needs of a formula for several noises.
pub const fn about<F: Implicit>() -> About {
    let (reads_areas, clips_increments) = (F::READS_AREAS, F::CLIPS_INCREMENTS);
    About { reads_areas, clips_increments, ..About::new(F::ID) }
}

#[inline(always)]
fn scaled<const D: usize>(mut y: [f64; D], factor: f64) -> [f64; D] {
    for i in 0..D {
        y[i] *= factor;
    }
    y
}

/// Whether the second half of the damping may give a state that is not finite.
#[inline(always)]
pub fn may_overflow(step: &Step) -> bool {
    step.second_decay > 1.0 || step.second_decay.is_nan()
}

/// The equation z = ψ(ẑ, z) of one path; F and S are references to the formula and the system.
#[derive(Clone, Copy)]
struct Equation<F, S, const D: usize, const M: usize> {
    formula: F,
    system: S,
    step: Step,
    noise: Noise<M>,
    start: [f64; D],
}

impl<F: Implicit, S: PoissonSystem<D, M>, const D: usize, const M: usize> FixedPoint<D>
    for Equation<&F, &S, D, M>
{
    const METHOD: Method = match S::IMPLICIT_STEP {
        ImplicitStep::FixedPoint | ImplicitStep::UnrolledFixedPoint => Method::FixedPoint,
        ImplicitStep::Newton | ImplicitStep::Predicted => Method::Newton,
    };

    const FIRST_SWEEP: FirstSweep = match S::IMPLICIT_STEP {
        ImplicitStep::FixedPoint => FirstSweep::Plain,
        ImplicitStep::Predicted if F::PREDICTED => FirstSweep::Predicted,
        _ => FirstSweep::Long,
    };

    #[inline(always)]
    fn start(&self) -> [f64; D] {
        self.start
    }

    #[inline(always)]
    fn map<R: Real>(&self, z: [R; D]) -> [R; D] {
        let Self { system, step, noise, .. } = *self;
        let increment = SystemIncrement { system, step, noise, number: PhantomData::<R> };
        self.formula.psi(increment, constant(self.start), crate::Vector(z)).0
    }

    #[inline(always)]
    fn predict(&self) -> ([f64; D], f64) {
        self.system.predict(self.start, self.step.tau, self.noise.increments)
    }
}

/// The equations of a block; F and S are references to the formula and the system.
#[derive(Clone, Copy)]
struct BlockEquation<'a, F, S, const D: usize, const M: usize> {
    formula: F,
    system: S,
    step: Step,
    noise: BlockNoise<'a, M>,
    /// Lévy areas of the block, for a formula that reads them.
    areas: [&'a [Row; M]; M],
    /// The states before the step.
    y: &'a Block<D>,
}

impl<'a, F: Implicit, S: PoissonSystem<D, M>, const D: usize, const M: usize> BlockFixedPoint<D>
    for BlockEquation<'a, &'a F, &'a S, D, M>
{
    type Path = Equation<&'a F, &'a S, D, M>;
    #[inline(always)]
    fn path(&self, p: usize) -> Self::Path {
        let Self { formula, system, step, noise, ref areas, y } = *self;
        let areas = if F::READS_AREAS { skew(areas, p) } else { [[0.0; M]; M] };
        let noise = Noise { areas, ..Noise::increments(path(noise.increments, p)) };
        let y = y.path(p);
        let start = if F::EXACT_DAMPING { scaled(y, step.first_decay) } else { y };
        Equation { formula, system, step, noise, start }
    }
}

/// One step of a block.
struct StepKernel<'a, F, S, const D: usize, const M: usize> {
    formula: &'a F,
    system: &'a S,
    step: &'a Step,
    noise: BlockNoise<'a, M>,
    y: &'a mut Block<D>,
    status: &'a mut BlockStatus,
}

impl<F: Implicit, S: PoissonSystem<D, M>, const D: usize, const M: usize> Kernel
    for StepKernel<'_, F, S, D, M>
{
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { formula, system, step, noise, y, status } = self;
        let step = *step;
        let areas = if F::READS_AREAS { noise.area_rows() } else { [BlockNoise::NO_AREAS; M] };
        if F::EXPLICIT {
            // Copies without other references, so that stores to them cannot change the noise.
            let (start, mut next) = (*y, *y);
            let equations = BlockEquation { formula, system, step, noise, areas, y: &start };
            for p in 0..WIDTH {
                next.set_path(p, equations.path(p).map(start.path(p)));
            }
            *y = next;
            *status = BlockStatus::explicit();
            status.fail_where_not_finite(&y.0);
            return;
        }
        let mut z = Block::zero();
        let equations = BlockEquation { formula, system, step, noise, areas, y };
        if const { F::SOLVER.is_none() } {
            nonlin::solve_block(&equations, &mut z, status);
        } else {
            solver(formula).solve_block(&equations, &mut z, status);
        }
        if F::EXACT_DAMPING {
            for p in 0..WIDTH {
                y.set_path(p, scaled(z.path(p), step.second_decay));
            }
            if may_overflow(&step) {
                status.fail_where_not_finite(&y.0);
            }
        } else {
            *y = z;
        }
    }
}
