//! What can be wrong with a ladder.

use std::fmt;

use noise::NoiseError;
use schemes::StepError;

/// What can be wrong with a ladder or a trajectory; found before anything is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum LadderError {
    /// The number of finest steps is zero or no multiple of the coarsest step.
    Steps {
        /// Number of finest steps asked for.
        steps: u64,
        /// What it must be a multiple of.
        multiple_of: u64,
    },
    /// A run is on a level that the ladder does not have; a swapped run needs a level above its
    /// own.
    Level {
        /// The level asked for.
        level: usize,
        /// Whether the run is swapped.
        swapped: bool,
        /// Levels of the ladder above the finest.
        levels: usize,
    },
    /// The increments cannot be truncated at one of the step sizes.
    Noise(NoiseError),
    /// A step size is not a positive number.
    Step(StepError),
}

impl fmt::Display for LadderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Steps { steps, multiple_of } => {
                write!(
                    f,
                    "the number of finest steps must be a positive multiple of {multiple_of}, got {steps}"
                )
            }
            Self::Level { level, swapped: false, levels } => {
                write!(f, "a run is on level {level}, but the ladder has levels 0 to {levels}")
            }
            Self::Level { level, swapped: true, levels } => {
                write!(
                    f,
                    "a swapped run on level {level} needs level {} above it, but the ladder has levels 0 to {levels}",
                    level + 1
                )
            }
            Self::Noise(error) => error.fmt(f),
            Self::Step(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for LadderError {}

impl From<NoiseError> for LadderError {
    fn from(error: NoiseError) -> Self {
        Self::Noise(error)
    }
}

impl From<StepError> for LadderError {
    fn from(error: StepError) -> Self {
        Self::Step(error)
    }
}
