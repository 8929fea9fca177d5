//! Formulas on systems known at run time.

use noise::StepNoise;
use nonlin::{BlockStatus, Outcome, Solver, criteria::excess};
use real::{PathMask, Row, Rows, WIDTH};
use systems::{
    Constant,
    paper::valid,
    run_time::{Lanes, System, Weights},
};

use super::{
    SchemeError,
    derivative::derivative,
    krylov::Krylov,
    machine::{Machine, multiple},
    norm::{changes, sums},
};
use crate::{
    Implicit, Listing, Step, Stepper, Sweeps,
    kernel::{may_overflow, solver},
};

/// A formula on 32 paths, or on one large path. An implicit one is solved by fixed-point iteration
/// as in [`nonlin::Method::FixedPoint`], and by Newton's method without a matrix on paths where
/// that does not converge.
pub struct FormulaStepper<'a, F> {
    formula: &'a F,
    system: &'a dyn System,
    /// An explicit formula, whose first buffer is the state; or a sweep, whose inputs are ẑ and the
    /// iterate, which is frozen where it has converged.
    machine: Machine<'a>,
    /// The state of an implicit formula.
    state: Rows,
    krylov: Option<Krylov<'a>>,
}

impl<'a, F: Implicit> FormulaStepper<'a, F> {
    pub fn new(formula: &'a F, system: &'a dyn System) -> Result<Self, SchemeError> {
        let rows = if F::EXPLICIT { 0 } else { system.description().layout.rows };
        let (machine, state) = (Machine::new(system), Rows::zero(rows));
        let mut stepper = Self { formula, system, machine, state, krylov: None };
        // A step by which the memory of a formula is found out.
        stepper.record(&valid(Step::new(&valid(Constant::new(0.0)), 0, 1.0)))?;
        Ok(stepper)
    }

    /// Records the formula, or a sweep, of a step.
    fn record(&mut self, step: &Step) -> Result<(), SchemeError> {
        let evaluations = if F::EXPLICIT { 1 } else { Sweeps::EVALUATIONS };
        if self.machine.record(self.formula, step, evaluations)? && !F::EXPLICIT {
            // A rescue needs the derivative, maybe after hours.
            derivative(self.machine.operations())?;
        }
        Ok(())
    }

    /// Sweeps until every path has converged or `most_sweeps` is reached. Returns minus the number
    /// of sweeps of a path that has converged; positive numbers on other paths.
    fn iterate(&mut self, h: Weights<'_>, most_sweeps: u32) -> Row {
        let mut pending = [1.0; WIDTH];
        for number in 1..=most_sweeps {
            self.machine.execute(h);
            let iterates = [0, 1, 2].map(|n| self.machine.result(n));
            let changes = sums(self.system, changes, iterates);
            let mut z = std::mem::take(&mut self.machine.buffers[1]);
            let (next, pending) = (self.machine.result(2), &mut pending);
            let finished = test_sweep(number, changes, next, &mut z, pending);
            self.machine.buffers[1] = z;
            if finished {
                break;
            }
        }
        pending
    }

    /// Solves some paths by Newton's method.
    fn rescue(
        &mut self,
        step: &Step,
        paths: PathMask,
        h: Weights<'_>,
    ) -> Result<[Outcome; WIDTH], SchemeError> {
        let krylov = self.krylov.get_or_insert_with(|| Krylov::new(self.system));
        let outcomes = krylov.solve(self.formula, step, h, &self.machine.buffers[0], paths)?;
        for (solution, z) in self.machine.buffers[1].iter_mut().zip(krylov.z.iter()) {
            for p in paths.paths() {
                solution[p] = z[p];
            }
        }
        Ok(outcomes)
    }

    /// The factors of damping around the equation.
    fn halves(step: &Step) -> [f64; 2] {
        if F::EXACT_DAMPING { [step.first_decay, step.second_decay] } else { [1.0; 2] }
    }

    /// A step of an implicit formula.
    fn solve(&mut self, step: &Step, h: Weights<'_>, status: &mut BlockStatus) {
        let [first, second] = Self::halves(step);
        for input in &mut self.machine.buffers[..2] {
            multiple(&self.state, first, input);
        }
        let solver = solver(self.formula);
        let pending = self.iterate(h, solver.max_sweeps.max(1));
        if solver.settle {
            // One more sweep on every path. The rescue overwrites those that have not converged.
            self.machine.execute(h);
            let mut z = std::mem::take(&mut self.machine.buffers[1]);
            z.copy_from_slice(self.machine.result(2));
            self.machine.buffers[1] = z;
        }
        *status = BlockStatus::fast(pending);
        let unsolved = PathMask::of(|p| pending[p] > 0.0);
        if !unsolved.is_empty() {
            let failed = [Outcome::Failed { residual: f64::INFINITY }; WIDTH];
            let solved = self.rescue(step, unsolved, h).unwrap_or(failed);
            let one_path = self.system.description().layout.lanes == Lanes::Components;
            let paths = if one_path { PathMask::first(1) } else { unsolved };
            paths.paths().for_each(|p| status.set(p, solved[p]));
        }
        let z = &self.machine.buffers[1];
        multiple(z, second, &mut self.state);
    }
}

impl<F: Implicit> Stepper for FormulaStepper<'_, F> {
    fn state(&self) -> &[Row] {
        if F::EXPLICIT { &self.machine.buffers[0] } else { &self.state }
    }

    fn state_mut(&mut self) -> &mut [Row] {
        if F::EXPLICIT { &mut self.machine.buffers[0] } else { &mut self.state }
    }

    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        *status = BlockStatus::explicit();
        // Operations that a formula did not have before may need more memory, or be refused.
        if self.record(step).is_err() {
            return status.fail_everywhere();
        }
        let t = step.t + 0.5 * step.tau;
        let h = Weights { t, dt: step.tau, dw: &noise.increments, areas: &noise.areas };
        if F::EXPLICIT {
            self.machine.execute(h);
            self.machine.feed_back(0);
        } else {
            self.solve(step, h, status);
        }
        let is_tested = F::EXPLICIT || F::EXACT_DAMPING && may_overflow(step);
        if is_tested && self.system.description().layout.lanes == Lanes::Paths {
            status.fail_where_not_finite(self.state());
        }
    }

    fn listing(&mut self, step: &Step) -> Option<Listing<'_>> {
        self.machine.record(self.formula, step, 1).ok()?;
        let Solver { max_sweeps, settle, .. } = solver(self.formula);
        let sweeps = Sweeps { most: max_sweeps.max(1), settle, factors: Self::halves(step) };
        let (program, factors) = self.machine.program()?;
        let listing = Listing::new(program, factors, step.tau, step.t + 0.5 * step.tau);
        Some(Listing { sweeps: (!F::EXPLICIT).then_some(sweeps), ..listing })
    }
}

real::kernel! {
    /// The end of a sweep: the test of every path by sums of the last two changes and of the last
    /// iterate, and the iterates of those that were not frozen. Returns whether all have converged.
    fn test_sweep(
        number: u32,
        sums: [Row; 3],
        next: &'a [Row],
        z: &'a mut [Row],
        pending: &'a mut Row
    ) -> bool {
        let [change, change_before, size] = sums;
        let number = f64::from(number);
        let frozen = *pending;
        let mut now = frozen;
        let mut unfinished = 0u64;
        for p in 0..WIDTH {
            let excess = excess(change[p], change_before[p], size[p]);
            let tested = if excess <= 0.0 { -number } else { 1.0 };
            now[p] = if frozen[p] <= 0.0 { frozen[p] } else { tested };
            unfinished = unfinished.wrapping_add(if now[p] <= 0.0 { 0 } else { 1 });
        }
        *pending = now;
        for (z, next) in z.iter_mut().zip(next) {
            let (mut row, next) = (*z, *next);
            for p in 0..WIDTH {
                row[p] = if frozen[p] <= 0.0 { row[p] } else { next[p] };
            }
            *z = row;
        }
        unfinished == 0
    }
}
