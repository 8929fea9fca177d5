//! Explicit formulas on systems known at run time.

use noise::StepNoise;
use nonlin::BlockStatus;
use real::{Kernel, Row, WIDTH, dispatch};
use systems::{
    Constant,
    run_time::{Lanes, System, Weights},
};

use super::{
    SchemeError,
    machine::Machine,
    record::{Recorder, Recording},
};
use crate::{Implicit, Step, Stepper};

/// A formula that does not depend on z.
pub struct ExplicitStepper<'a, F> {
    formula: &'a F,
    system: &'a dyn System,
    recorder: Recorder,
    /// The state is the first buffer.
    machine: Machine<'a>,
}

impl<'a, F: Implicit> ExplicitStepper<'a, F> {
    pub fn new(formula: &'a F, system: &'a dyn System) -> Result<Self, SchemeError> {
        let machine = Machine::new(system)?;
        let recorder = Recorder::default();
        let mut stepper = Self { formula, system, recorder, machine };
        stepper.prepare(&some_step())?;
        Ok(stepper)
    }

    /// Records the formula for a step, and plans it if its operations are new.
    fn prepare(&mut self, step: &Step) -> Result<(), SchemeError> {
        let [y] = self.recorder.restart();
        let h = Recording { system: self.system, step, recorder: &self.recorder };
        let result = self.formula.psi(h, y, y);
        if !self.recorder.finish(result.number) {
            return Ok(());
        }
        self.machine.prepare(self.recorder.operations().0, &[true])
    }
}

/// A step by which the memory of a formula is found out.
pub fn some_step() -> Step {
    let step = Constant::new(0.0).map(|damping| Step::new(&damping, 0, 1.0));
    step.unwrap_or_else(|error| unreachable!("{error}"))
        .unwrap_or_else(|error| unreachable!("{error}"))
}

impl<F: Implicit> Stepper for ExplicitStepper<'_, F> {
    fn state(&self) -> &[Row] {
        &self.machine.buffers[0]
    }

    fn state_mut(&mut self) -> &mut [Row] {
        &mut self.machine.buffers[0]
    }

    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        // Operations that a formula did not have before may need more memory, or be refused.
        if self.prepare(step).is_err() {
            *status = BlockStatus::explicit();
            return status.fail_everywhere();
        }
        let h = Weights { dt: step.tau, dw: &noise.increments };
        self.machine.execute(self.recorder.operations().1, h);
        self.machine.feed_back(0);
        let y = match self.system.lanes() {
            Lanes::Paths => self.state(),
            Lanes::Components => &[],
        };
        dispatch(Check { y, status });
    }
}

/// The status of an explicit step, in which paths with a state that is not finite fail.
struct Check<'a> {
    y: &'a [Row],
    status: &'a mut BlockStatus,
}

impl Kernel for Check<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        *self.status = BlockStatus::explicit();
        // 0·y is NaN if y is infinite or NaN, else zero of some sign: the first bit.
        let mut bits = 0;
        for row in self.y {
            for p in 0..WIDTH {
                bits |= (0.0 * row[p]).to_bits();
            }
        }
        if bits << 1 != 0 {
            self.status.fail_where_not_finite(self.y);
        }
    }
}
