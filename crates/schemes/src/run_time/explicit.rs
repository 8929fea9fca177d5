//! Explicit formulas on systems known at run time.

use noise::StepNoise;
use nonlin::BlockStatus;
use real::Row;
use systems::{
    Constant,
    paper::valid,
    run_time::{Lanes, System, Weights},
};

use super::{SchemeError, machine::Machine};
use crate::{Implicit, Step, Stepper};

/// A formula that does not depend on z.
pub struct ExplicitStepper<'a, F> {
    formula: &'a F,
    lanes: Lanes,
    /// The state is the first buffer.
    machine: Machine<'a>,
}

impl<'a, F: Implicit> ExplicitStepper<'a, F> {
    pub fn new(formula: &'a F, system: &'a dyn System) -> Result<Self, SchemeError> {
        let mut machine = Machine::new(system)?;
        machine.record(formula, &some_step(), 1)?;
        Ok(Self { formula, lanes: system.description().layout.lanes, machine })
    }
}

/// A step by which the memory of a formula is found out.
pub fn some_step() -> Step {
    valid(Step::new(&valid(Constant::new(0.0)), 0, 1.0))
}

impl<F: Implicit> Stepper for ExplicitStepper<'_, F> {
    fn state(&self) -> &[Row] {
        &self.machine.buffers[0]
    }

    fn state_mut(&mut self) -> &mut [Row] {
        &mut self.machine.buffers[0]
    }

    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        *status = BlockStatus::explicit();
        // Operations that a formula did not have before may need more memory, or be refused.
        if self.machine.record(self.formula, step, 1).is_err() {
            return status.fail_everywhere();
        }
        self.machine.execute(Weights { dt: step.tau, dw: &noise.increments, areas: &noise.areas });
        self.machine.feed_back(0);
        if self.lanes == Lanes::Paths {
            status.fail_where_not_finite(self.state());
        }
    }
}
