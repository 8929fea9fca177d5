//! Implicit formulas on systems known at run time.

use noise::StepNoise;
use nonlin::{BlockStatus, Outcome};
use real::{Kernel, PathMask, Row, Rows, WIDTH, dispatch};
use systems::run_time::{Lanes, System, Weights};

use super::{
    SchemeError,
    derivative::derivative,
    explicit::some_step,
    krylov::{Equation, Krylov},
    machine::{Machine, Multiple},
    norm::{Distance, Size, sum},
    record::{Recorder, Recording},
    sweep::{Pending, Sweep, excess},
};
use crate::{Implicit, Step, Stepper};

/// An implicit formula, solved by fixed-point iteration as in [`nonlin::Method::FixedPoint`], and
/// by Newton's method without a matrix on paths where that does not converge.
pub struct ImplicitStepper<'a, F> {
    formula: &'a F,
    system: &'a dyn System,
    recorder: Recorder,
    /// ẑ and z are the first buffers.
    machine: Machine<'a>,
    /// The state; the iterates that have converged; an earlier iterate.
    state: Rows,
    solution: Rows,
    previous: Rows,
    sweep: Option<Sweep>,
    krylov: Option<Krylov<'a>>,
}

impl<'a, F: Implicit> ImplicitStepper<'a, F> {
    pub fn new(formula: &'a F, system: &'a dyn System) -> Result<Self, SchemeError> {
        let rows = || Rows::zero(system.rows());
        let mut stepper = Self {
            formula,
            system,
            recorder: Recorder::default(),
            machine: Machine::new(system)?,
            state: rows()?,
            solution: rows()?,
            previous: rows()?,
            sweep: None,
            krylov: None,
        };
        stepper.sweep = Sweep::new(formula, system, &some_step())?;
        stepper.prepare(&some_step())?;
        Ok(stepper)
    }

    /// Records the formula for a step, and plans it if its operations are new.
    fn prepare(&mut self, step: &Step) -> Result<(), SchemeError> {
        let [start, z] = self.recorder.restart();
        let h = Recording { system: self.system, step, recorder: &self.recorder };
        let result = self.formula.psi(h, start, z);
        if !self.recorder.finish(result.number) {
            return Ok(());
        }
        let (nodes, factors) = self.recorder.operations();
        // A rescue needs the derivative, maybe after hours.
        derivative(nodes, factors)?;
        self.machine.prepare(nodes, &[false; 2])
    }

    /// ψ of the iterate, which becomes the iterate.
    fn evaluate(&mut self, h: Weights<'_>) {
        self.machine.execute(self.recorder.operations().1, h);
        self.machine.feed_back(1);
    }

    /// Sweeps of three evaluations until every path has converged or their number is reached.
    fn iterate(&mut self, step: &Step, h: Weights<'_>, most_sweeps: u32) -> Pending {
        let mut pending = [1.0; WIDTH];
        if let Some(sweep) = &mut self.sweep
            && sweep.record(self.formula, self.system, step)
        {
            let start = &self.machine.buffers[0];
            sweep.iterate(start, h, most_sweeps, &mut self.solution, &mut pending);
            return pending;
        }
        let system = self.system;
        for sweep in 1..=most_sweeps {
            self.machine.buffers[1].copy_from_slice(&self.solution);
            self.evaluate(h);
            self.previous.copy_from_slice(&self.machine.buffers[1]);
            self.evaluate(h);
            self.machine.execute(self.recorder.operations().1, h);
            let (before, next) =
                (&self.machine.buffers[1], &self.machine.buffers[self.machine.result()]);
            let change = sum(system, Distance, next, before);
            let change_before = sum(system, Distance, before, &self.previous);
            let size = sum(system, Size, next, next);
            let frozen = pending;
            for p in 0..WIDTH {
                let excess = excess(change[p], change_before[p], size[p]);
                let now = if excess <= 0.0 { -f64::from(sweep) } else { 1.0 };
                pending[p] = if frozen[p] <= 0.0 { frozen[p] } else { now };
            }
            dispatch(Select { frozen: &frozen, next, solution: &mut self.solution });
            if pending.iter().all(|&pending| pending <= 0.0) {
                break;
            }
        }
        pending
    }

    /// Solves some paths by Newton's method.
    fn rescue(&mut self, paths: PathMask, h: Weights<'_>) -> Result<[Outcome; WIDTH], SchemeError> {
        let krylov = match &mut self.krylov {
            Some(krylov) => krylov,
            none => none.insert(Krylov::new(self.system)?),
        };
        let (nodes, factors) = self.recorder.operations();
        let start = &self.machine.buffers[0];
        let outcomes = krylov.solve(&Equation { nodes, factors, h, start }, paths)?;
        for (solution, z) in self.solution.iter_mut().zip(krylov.z.iter()) {
            for p in paths.paths() {
                solution[p] = z[p];
            }
        }
        Ok(outcomes)
    }
}

impl<F: Implicit> Stepper for ImplicitStepper<'_, F> {
    fn state(&self) -> &[Row] {
        &self.state
    }

    fn state_mut(&mut self) -> &mut [Row] {
        &mut self.state
    }

    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        *status = BlockStatus::explicit();
        // Operations that a formula did not have before may need more memory, or be refused.
        if self.prepare(step).is_err() {
            return status.fail_everywhere();
        }
        let h = Weights { dt: step.tau, dw: &noise.increments };
        let (first, second) =
            if F::EXACT_DAMPING { (step.first_decay, step.second_decay) } else { (1.0, 1.0) };
        dispatch(Multiple { x: &self.state, factor: first, out: &mut self.machine.buffers[0] });
        self.solution.copy_from_slice(&self.machine.buffers[0]);
        let solver = self.formula.solver();
        let pending = self.iterate(step, h, solver.max_sweeps.max(1));
        if solver.settle {
            self.settle(h);
        }
        *status = BlockStatus::fast(pending);
        let mut unsolved = PathMask::NONE;
        (0..WIDTH).filter(|&p| pending[p] > 0.0).for_each(|p| unsolved.insert(p));
        if !unsolved.is_empty() {
            let failed = [Outcome::Failed { residual: f64::INFINITY }; WIDTH];
            let solved = self.rescue(unsolved, h).unwrap_or(failed);
            let one_path = self.system.lanes() == Lanes::Components;
            let paths = if one_path { PathMask::first(1) } else { unsolved };
            paths.paths().for_each(|p| status.set(p, solved[p]));
        }
        dispatch(Multiple { x: &self.solution, factor: second, out: &mut self.state });
        // The second half of the damping may give a state that is not finite.
        if (second > 1.0 || second.is_nan()) && self.system.lanes() == Lanes::Paths {
            status.fail_where_not_finite(self.state());
        }
    }
}

impl<F: Implicit> ImplicitStepper<'_, F> {
    /// One more sweep on every path. The rescue overwrites those that have not converged.
    fn settle(&mut self, h: Weights<'_>) {
        self.machine.buffers[1].copy_from_slice(&self.solution);
        for _ in 0..3 {
            self.evaluate(h);
        }
        self.solution.copy_from_slice(&self.machine.buffers[1]);
    }
}

/// solution ← next on paths that were not frozen.
struct Select<'a> {
    frozen: &'a Pending,
    next: &'a [Row],
    solution: &'a mut [Row],
}

impl Kernel for Select<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for (solution, next) in self.solution.iter_mut().zip(self.next) {
            let (mut row, next) = (*solution, *next);
            for p in 0..WIDTH {
                row[p] = if self.frozen[p] <= 0.0 { row[p] } else { next[p] };
            }
            *solution = row;
        }
    }
}
