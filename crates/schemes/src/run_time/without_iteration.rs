//! `sexp-li` and `split` on systems known at run time.

use nonlin::BlockStatus;
use real::{OutOfMemory, Row, Rows};
use systems::run_time::{Lanes, System, Weights};

use super::{Scheme, SchemeError, Stepper, explicit::ExplicitStepper};
use crate::{SexpLi, Split, Step, sexp_li::LinearlyImplicit, split};

impl Scheme for SexpLi {
    fn id(&self) -> &'static str {
        self.name()
    }

    fn clips_increments(&self) -> bool {
        self.clips
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Result<Box<dyn Stepper + 'a>, SchemeError> {
        if self.areas {
            let (system, noises) = (system.name().into(), system.noises());
            return Err(SchemeError::Areas { scheme: self.name(), system, noises });
        }
        Ok(if self.implicit {
            Box::new(ExplicitStepper::new(&LinearlyImplicit::<true, false>, system)?)
        } else {
            Box::new(ExplicitStepper::new(&LinearlyImplicit::<false, false>, system)?)
        })
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
        let parts = system
            .parts()
            .map_err(|reason| SchemeError::Parts { system: system.name().into(), reason })?;
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
        Ok(Self {
            system,
            parts,
            state: Rows::zero(system.rows())?,
            half_dw: Rows::zero(system.noise_rows())?,
            scratch: Rows::zero(system.scratch_rows())?,
        })
    }
}

/// A step of the state.
struct Moving<'s, 'a> {
    stepper: &'s mut SplitStepper<'a>,
    tau: f64,
    dw: &'s [Row],
}

impl split::Moved for Moving<'_, '_> {
    fn scale(&mut self, factor: f64) {
        self.stepper.state.iter_mut().flatten().for_each(|y| *y *= factor);
    }

    fn flow(&mut self, part: usize, half: bool) {
        let SplitStepper { system, state, half_dw, scratch, .. } = &mut *self.stepper;
        let h = match half {
            true => Weights { dt: 0.5 * self.tau, dw: half_dw },
            false => Weights { dt: self.tau, dw: self.dw },
        };
        system.flow(part, state, h, scratch);
    }
}

impl Stepper for SplitStepper<'_> {
    fn state(&self) -> &[Row] {
        &self.state
    }

    fn state_mut(&mut self) -> &mut [Row] {
        &mut self.state
    }

    fn step(&mut self, step: &Step, dw: &[Row], status: &mut BlockStatus) {
        *status = BlockStatus::explicit();
        let halves = self.half_dw.iter_mut().flatten().zip(dw.iter().flatten());
        halves.for_each(|(half, dw)| *half = 0.5 * dw);
        let parts = self.parts;
        split::compose(parts, step, &mut Moving { stepper: self, tau: step.tau, dw });
        if self.system.lanes() == Lanes::Paths {
            status.fail_where_not_finite(&self.state);
        }
    }
}
