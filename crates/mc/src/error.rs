//! Failed paths, and errors of ladders and of what runs them.

use std::collections::HashSet;

use noise::{NoiseError, StreamKey};
use schemes::{StepError, run_time::SchemeError};
use serde::{Deserialize, Serialize};

use crate::{MemoryError, parts::JobError};

/// The reason why a path failed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum Cause {
    /// The solver found no solution of the implicit step.
    #[error("no solution found, residual {residual:e}")]
    NoSolution {
        /// ‖z − ψ(z)‖₁ at the last iterate.
        residual: f64,
    },
    /// The state is NaN or infinite.
    #[error("the state is not finite")]
    NotFinite,
}

impl Cause {
    /// The reason of a failed step with this residual, which is infinite if the state is not
    /// finite.
    pub fn of_residual(residual: f64) -> Self {
        if residual == f64::INFINITY { Self::NotFinite } else { Self::NoSolution { residual } }
    }
}

/// A failed path, with everything needed to replay it. Statistics exclude it from this time on.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "path {path} (seed {}, experiment {}): {scheme}{} at tau = {tau}, step {step}, t = {}: {cause}",
    key.seed,
    key.experiment,
    if *swapped { ", increments exchanged," } else { "" },
    *step as f64 * tau
)]
pub struct PathFailure {
    /// Number of the path; of Sobol points 2³² times the scramble plus the point.
    pub path: u64,
    /// Key of the random streams of the path.
    pub key: StreamKey,
    /// Identifier of the scheme.
    pub scheme: &'static str,
    /// Whether the run was swapped, see [`Run`](crate::Run).
    pub swapped: bool,
    /// The step size.
    pub tau: f64,
    /// The number of the failed step, counted from zero.
    pub step: u64,
    /// Reason of the failure.
    pub cause: Cause,
}

/// An invalid ladder, detected before the first step.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LadderError {
    /// The number of finest steps is not a positive multiple of those in a coarsest step.
    #[error("the number of finest steps must be a positive multiple of {multiple_of}, got {steps}")]
    Steps {
        /// The given number of finest steps.
        steps: u64,
        /// The number of finest steps in a coarsest step.
        multiple_of: u64,
    },
    /// The level of a run exceeds those of the ladder. A swapped run needs the level above its own.
    #[error(
        "a run on level {level} (swapped: {swapped}) needs level {} of the ladder, which has \
         levels 0 to {levels}",
        level + usize::from(*swapped)
    )]
    Level {
        /// The given level.
        level: usize,
        /// Whether the run is swapped.
        swapped: bool,
        /// The number of levels above the finest.
        levels: usize,
    },
    /// Noise cannot be truncated, or areas cannot be drawn, at one of the step sizes.
    #[error(transparent)]
    Noise(#[from] NoiseError),
    /// A measurement has too few step sizes, or too many.
    #[error("the number of step sizes must be from {from} to {to}, got {given}")]
    StepSizes {
        /// The given number of step sizes.
        given: usize,
        /// The least number allowed.
        from: usize,
        /// The largest number allowed.
        to: usize,
    },
    /// A step size is not positive and finite.
    #[error(transparent)]
    Step(#[from] StepError),
    /// The scheme is not for the system.
    #[error(transparent)]
    Scheme(#[from] SchemeError),
    /// The states of the paths take more memory than is free.
    #[error(transparent)]
    Memory(#[from] MemoryError),
}

/// Reason why a simulation, study, expectation or comparison has no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// A setting is out of range, missing or given twice. The text says which.
    #[error("{0}")]
    Setting(String),
    /// The scheme cannot be run on these steps.
    #[error(transparent)]
    Ladder(#[from] LadderError),
    /// The pilot of an expectation costs more path-steps than allowed; nothing was computed.
    #[error("the pilot takes {pilot_cost} path-steps, but {max_cost} are allowed")]
    PilotCost {
        /// Path-steps of the pilot.
        pilot_cost: u64,
        /// Path-steps allowed.
        max_cost: u64,
    },
    /// The computation takes more memory than is free; nothing was computed.
    #[error(transparent)]
    Memory(#[from] MemoryError),
    /// A checkpoint cannot be read, is damaged, or is of another computation.
    #[error("{0}")]
    Checkpoint(String),
    /// An expectation was stopped before it had estimates.
    #[error("stopped before the first estimates")]
    Stopped,
    /// Almost every path of a level of an expectation failed, so there is no estimate on it.
    #[error(
        "{failed} paths failed on level {level}, which leaves too few{}",
        first.map_or_else(String::new, |failure| format!("; {failure}"))
    )]
    NoPaths {
        /// Number of the level.
        level: usize,
        /// Number of failed paths.
        failed: u64,
        /// The first failure.
        first: Option<PathFailure>,
    },
    /// A test function of an expectation is not finite on a path whose state is.
    #[error("the test function {observable} is not finite on a path of level {level}")]
    NotFinite {
        /// Name of the test function.
        observable: String,
        /// Number of the level.
        level: usize,
    },
}

impl From<JobError> for RunError {
    fn from(error: JobError) -> Self {
        Self::Checkpoint(error.to_string())
    }
}

impl RunError {
    /// Refuses `names` of which two are equal; `what` is the word for their kind.
    pub fn twice<T: AsRef<str>>(what: &str, names: &[T]) -> Result<(), Self> {
        let mut seen = HashSet::new();
        names.iter().map(AsRef::as_ref).find(|name| !seen.insert(*name)).map_or(Ok(()), |name| {
            Err(Self::Setting(format!("two {what} have the name {name:?}; rename one")))
        })
    }

    /// Refuses the first of `settings` that is not met; each has its name and the values allowed.
    ///
    /// # Errors
    /// [`Setting`](Self::Setting).
    pub fn unmet(
        settings: impl IntoIterator<Item = (bool, &'static str, &'static str, f64)>,
    ) -> Result<(), Self> {
        settings.into_iter().find(|(met, ..)| !met).map_or(Ok(()), |(_, name, allowed, value)| {
            Err(Self::Setting(format!("the {name} must be {allowed}, got {value}")))
        })
    }
}
