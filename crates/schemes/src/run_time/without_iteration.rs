//! Schemes that are not one formula on systems known at run time: `sexp-li`, `sexp-levy`, `split`.

use noise::StepNoise;
use nonlin::BlockStatus;
use real::{OutOfMemory, Row, Rows};
use systems::run_time::{Description, Lanes, System, Weights};

use super::{Scheme, SchemeError};
use crate::{
    Implicit, Sexp, SexpLevy, SexpLi, Split, Step, Stepper, sexp_levy::WithAreas,
    sexp_li::LinearlyImplicit,
};

impl Scheme for SexpLi {
    fn id(&self) -> &'static str {
        self.name()
    }

    fn reads_areas(&self) -> bool {
        self.areas
    }

    fn clips_increments(&self) -> bool {
        self.clips
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Result<Box<dyn Stepper + 'a>, SchemeError> {
        match (self.implicit, self.areas) {
            (true, true) => LinearlyImplicit::<true, true>.stepper(system),
            (true, false) => LinearlyImplicit::<true, false>.stepper(system),
            (false, true) => LinearlyImplicit::<false, true>.stepper(system),
            (false, false) => LinearlyImplicit::<false, false>.stepper(system),
        }
    }
}

impl Scheme for SexpLevy {
    fn id(&self) -> &'static str {
        WithAreas::ID
    }

    fn reads_areas(&self) -> bool {
        !self.commuting()
    }

    fn clips_increments(&self) -> bool {
        true
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Result<Box<dyn Stepper + 'a>, SchemeError> {
        match self.commuting() {
            true => Sexp.stepper(system),
            false => WithAreas.stepper(system),
        }
    }
}

impl Scheme for Split {
    fn id(&self) -> &'static str {
        "split"
    }

    fn clips_increments(&self) -> bool {
        false
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Result<Box<dyn Stepper + 'a>, SchemeError> {
        let Description { name, parts, .. } = system.description();
        let parts = parts.clone().map_err(|reason| SchemeError::parts("split", name, &reason))?;
        Ok(Box::new(SplitStepper::new(system, parts)?))
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

impl<'a> SplitStepper<'a> {
    fn new(system: &'a dyn System, parts: usize) -> Result<Self, OutOfMemory> {
        let description = system.description();
        Ok(Self {
            system,
            parts,
            state: Rows::zero(description.layout.rows)?,
            half_dw: Rows::zero(description.layout.noise_rows)?,
            scratch: Rows::zero(description.scratch_rows())?,
        })
    }
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
