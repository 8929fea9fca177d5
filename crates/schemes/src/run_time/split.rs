//! Compositions of exact flows for systems known at run time.

use noise::StepNoise;
use nonlin::BlockStatus;
use real::{Row, Rows};
use systems::run_time::{Description, Lanes, System, Weights};

use super::{Scheme, SchemeError};
use crate::{About, Split, Step, Stepper};

impl Scheme for Split {
    fn about(&self) -> About {
        About::new("split")
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Result<Box<dyn Stepper + 'a>, SchemeError> {
        let description = system.description();
        let Description { name, parts, layout, .. } = description;
        let parts = parts.clone().map_err(|reason| SchemeError::parts("split", name, &reason))?;
        Ok(Box::new(SplitStepper {
            system,
            parts,
            state: Rows::zero(layout.rows),
            half_dw: Rows::zero(layout.noise_rows),
            scratch: Rows::zero(description.scratch_rows()),
        }))
    }
}

/// Exact flows in turn.
struct SplitStepper<'a> {
    system: &'a dyn System,
    parts: usize,
    state: Rows,
    half_dw: Rows,
    scratch: Rows,
}

impl Stepper for SplitStepper<'_> {
    fn state(&self) -> &[Row] {
        &self.state
    }

    fn state_mut(&mut self) -> &mut [Row] {
        &mut self.state
    }

    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        *status = BlockStatus::explicit();
        let Self { system, parts, state, half_dw, scratch } = self;
        let halves = half_dw.iter_mut().flatten().zip(noise.increments.iter().flatten());
        halves.for_each(|(half, dw)| *half = 0.5 * dw);
        let whole = Weights { dt: step.tau, dw: &noise.increments, ..Weights::NONE };
        let half = Weights { dt: 0.5 * step.tau, dw: half_dw, ..Weights::NONE };
        state.iter_mut().flatten().for_each(|y| *y *= step.first_decay);
        let last = *parts - 1;
        for part in (0..=last).chain((0..last).rev()) {
            system.flow(part, state, if part < last { half } else { whole }, scratch);
        }
        state.iter_mut().flatten().for_each(|y| *y *= step.second_decay);
        if self.system.description().layout.lanes == Lanes::Paths {
            status.fail_where_not_finite(&self.state);
        }
    }
}
