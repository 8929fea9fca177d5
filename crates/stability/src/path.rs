//! One path of one scheme, until its end or a typed error.

use std::fmt;

use noise::{AreaMethod, AreaPath, StreamKey, Truncation, WienerPath};
use nonlin::Outcome;
use schemes::{SexpLevy, Step, StepError};
use systems::{Damping, PoissonSystem};

use crate::method::{Method, Noise};

/// Sees the number of a step, the step, the state after it and how it was solved.
pub(crate) type Observe<'a, const D: usize> = dyn FnMut(u64, &Step, [f64; D], Outcome) + 'a;

/// A system with damping, start and steps.
pub(crate) struct Path<'a, S, const D: usize> {
    pub(crate) system: &'a S,
    pub(crate) damping: &'a dyn Damping,
    pub(crate) y0: [f64; D],
    pub(crate) tau: f64,
    pub(crate) steps: u64,
}

/// Why a path ended before its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Stop {
    /// [`Step::new`] refused the step.
    Step { step: u64, error: StepError },
    /// The implicit equation has no solution that the solvers find.
    NoSolution { step: u64 },
    /// The step said so, or its state is not finite.
    NotFinite { step: u64 },
    /// The state is where the system is not defined.
    OutsideDomain { step: u64 },
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Step { step, .. } => write!(f, "step {step} refused"),
            Self::NoSolution { step } => write!(f, "no solution in step {step}"),
            Self::NotFinite { step } => write!(f, "overflow in step {step}"),
            Self::OutsideDomain { step } => write!(f, "outside the domain after step {step}"),
        }
    }
}

impl<S, const D: usize> Path<'_, S, D> {
    /// Runs the path; `observe` sees every step with its solution. Steps are counted from 1.
    pub(crate) fn run<const M: usize>(
        &self,
        method: Method,
        noise: &mut dyn FnMut() -> Noise<M>,
        observe: &mut Observe<'_, D>,
    ) -> Result<[f64; D], Stop>
    where
        S: PoissonSystem<D, M>,
    {
        let levy = SexpLevy::new(self.system, self.y0);
        let mut y = self.y0;
        for n in 0..self.steps {
            let number = n + 1;
            let step = Step::new(self.damping, n, self.tau)
                .map_err(|error| Stop::Step { step: number, error })?;
            let solution = method.step(self.system, &levy, &step, noise(), y);
            y = solution.z;
            if y.iter().any(|component| !component.is_finite()) {
                return Err(Stop::NotFinite { step: number });
            }
            if !solution.outcome.converged() {
                return Err(Stop::NoSolution { step: number });
            }
            if self.system.check_domain(y).is_err() {
                return Err(Stop::OutsideDomain { step: number });
            }
            observe(number, &step, y, solution.outcome);
        }
        Ok(y)
    }
}

/// Truncation order of all cases, that of the reproduction.
const TRUNCATION_ORDER: u32 = 4;
/// Terms of a drawn area: its law does not matter here, only its size.
const AREA_TERMS: usize = 2;

/// Truncated increments and areas of one path at steps of size τ ∈ (0, 1).
pub(crate) fn truncated_noise<const M: usize>(
    key: StreamKey,
    path: u64,
    tau: f64,
) -> impl FnMut() -> Noise<M> {
    let truncation = Truncation::new(TRUNCATION_ORDER).unwrap_or_else(|_| Truncation::none());
    let bound = truncation.bound(tau).unwrap_or(f64::INFINITY);
    let area_bound = truncation.area_bound(tau).unwrap_or(f64::INFINITY);
    let mut increments = WienerPath::<M>::new(key, path);
    let mut areas = AreaPath::<M>::new(key, path, AreaMethod::MrongowiusRoessler, AREA_TERMS);
    move || {
        let dw = increments.increments(tau.sqrt());
        let drawn = areas.areas(tau, dw);
        Noise {
            dw: dw.map(|w| w.clamp(-bound, bound)),
            areas: drawn.map(|row| row.map(|area| area.clamp(-area_bound, area_bound))),
        }
    }
}
