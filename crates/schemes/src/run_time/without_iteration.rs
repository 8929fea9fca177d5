//! `sexp-li`, `split` and `nv` on systems known at run time.

use noise::StepNoise;
use nonlin::BlockStatus;
use real::{OutOfMemory, Row, Rows, WIDTH};
use systems::run_time::{Lanes, System, Weights};

use super::{Scheme, SchemeError, explicit::ExplicitStepper};
use crate::{
    Implicit, Nv, SexpLi, Split, StageFlows, Step, Stepper, Sweep, nv, poisson_flow::PoissonFlow,
    sexp_li::LinearlyImplicit, split,
};

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

    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        *status = BlockStatus::explicit();
        let dw = &noise.increments[..];
        let halves = self.half_dw.iter_mut().flatten().zip(dw.iter().flatten());
        halves.for_each(|(half, dw)| *half = 0.5 * dw);
        let parts = self.parts;
        split::compose(parts, step, &mut Moving { stepper: self, tau: step.tau, dw });
        if self.system.lanes() == Lanes::Paths {
            status.fail_where_not_finite(&self.state);
        }
    }
}

impl Scheme for Nv<StageFlows> {
    fn id(&self) -> &'static str {
        nv::ID
    }

    fn clips_increments(&self) -> bool {
        false
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Result<Box<dyn Stepper + 'a>, SchemeError> {
        nv::refuse_local_noise(system)?;
        Ok(match self.is_affine() {
            true => Box::new(NvStepper::new(self.sweep(), &PoissonFlow::<true>, system)?),
            false => Box::new(NvStepper::new(self.sweep(), &PoissonFlow::<false>, system)?),
        })
    }
}

/// Flows of the Hamiltonians one by one.
struct NvStepper<'a, F> {
    sweep: Sweep,
    flow: ExplicitStepper<'a, F>,
    noises: usize,
    /// The increment of one noise, zero for all others.
    single: StepNoise,
}

impl<'a, F: Implicit> NvStepper<'a, F> {
    fn new(sweep: Sweep, flow: &'a F, system: &'a dyn System) -> Result<Self, SchemeError> {
        let flow = ExplicitStepper::new(flow, system)?;
        let single = Rows::zero(system.noise_rows())?.into();
        Ok(Self { sweep, flow, noises: system.noises(), single })
    }
}

/// A step by flows of the Hamiltonians.
struct Flowing<'s, 'a, F> {
    stepper: &'s mut NvStepper<'a, F>,
    half_tau: f64,
    dw: &'s [Row],
    status: &'s mut BlockStatus,
}

impl<F: Implicit> Flowing<'_, '_, F> {
    /// The flow of H₀dt and of the single noise. A path that fails stays failed: its state is not
    /// finite.
    fn flow(&mut self, dt: f64) {
        let NvStepper { flow, single, .. } = &mut *self.stepper;
        flow.step(&Step::without_damping(dt), single, self.status);
    }
}

impl<F: Implicit> nv::Moved for Flowing<'_, '_, F> {
    fn scale(&mut self, factor: f64) {
        self.stepper.flow.state_mut().iter_mut().flatten().for_each(|y| *y *= factor);
    }

    fn drift(&mut self) {
        self.flow(self.half_tau);
    }

    fn noises(&mut self, backward: bool) {
        let noises = self.stepper.noises;
        for k in 0..noises {
            let m = if backward { noises - 1 - k } else { k };
            self.stepper.single.increments[m] = self.dw[m];
            self.flow(0.0);
            self.stepper.single.increments[m] = [0.0; WIDTH];
        }
    }
}

impl<F: Implicit> Stepper for NvStepper<'_, F> {
    fn state(&self) -> &[Row] {
        self.flow.state()
    }

    fn state_mut(&mut self) -> &mut [Row] {
        self.flow.state_mut()
    }

    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        let backward = self.noises > 1 && self.sweep.is_backward(step);
        let (half_tau, dw) = (0.5 * step.tau, &noise.increments[..]);
        nv::compose(backward, step, &mut Flowing { stepper: self, half_tau, dw, status });
    }
}
