//! Errors of ladders.

use noise::NoiseError;
use schemes::StepError;

/// An invalid ladder or trajectory, detected before the first step.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
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
    /// A step size is not positive and finite.
    #[error(transparent)]
    Step(#[from] StepError),
}
