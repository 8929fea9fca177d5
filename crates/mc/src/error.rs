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
    /// A recording has more or fewer noises than the problem.
    #[error("the recording must have the {noises} noises of the problem, got {recorded}")]
    RecordedNoises {
        /// The noises of the recording.
        recorded: usize,
        /// The noises of the problem.
        noises: usize,
    },
    /// A recording has more or fewer steps than the ladder has finest steps.
    #[error("the recording must have as many steps as the finest level, {steps}, got {recorded}")]
    RecordedSteps {
        /// The steps of the recording.
        recorded: u64,
        /// The finest steps of the ladder.
        steps: u64,
    },
    /// A recording does not end at the final time.
    #[error(
        "the recorded increments must end at the final time T = {t_end} of the problem, got \
         {recorded}"
    )]
    Duration {
        /// The end of the recording.
        recorded: f64,
        /// The final time of the problem.
        t_end: f64,
    },
    /// A scheme reads Lévy areas and the recording has none.
    #[error(
        "{scheme} reads Levy areas: the recording must have the columns A12, A13, ..., got \
         increments only"
    )]
    NoAreas {
        /// The scheme.
        scheme: &'static str,
    },
    /// A measurement has too few step sizes, or too many.
    #[error("the number of step sizes must be from {from} to {to}, got {given}")]
    StepSizes {
        /// The given number.
        given: usize,
        /// The least.
        from: usize,
        /// The most.
        to: usize,
    },
    /// A step size is not positive and finite.
    #[error(transparent)]
    Step(#[from] StepError),
}
