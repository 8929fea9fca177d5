//! What can be wrong with the request for an expectation.

use std::fmt;

use crate::{LadderError, PathFailure};

/// Why there is no expectation, not even an inaccurate one.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum MultilevelError {
    /// The accuracy is not a positive number.
    Accuracy {
        /// The accuracy asked for.
        accuracy: f64,
    },
    /// There is no test function.
    NoObservable,
    /// The experiment number is too large to derive those of the levels from it.
    Experiment {
        /// The number given.
        experiment: u64,
    },
    /// The number of coarsest steps is zero or too large.
    CoarsestSteps {
        /// The number given.
        steps: u64,
        /// The largest allowed.
        at_most: u64,
    },
    /// The weak order is not a positive number.
    WeakOrder {
        /// The order given.
        weak_order: f64,
    },
    /// Too few pilot paths to estimate variances.
    Pilot {
        /// The number given.
        pilot: u64,
        /// The fewest allowed.
        at_least: u64,
    },
    /// The finest level is out of range.
    MaxLevel {
        /// The level given.
        max_level: usize,
        /// The lowest allowed.
        at_least: usize,
        /// The highest allowed.
        at_most: usize,
    },
    /// The pilot alone costs more path-steps than allowed; nothing was computed.
    PilotCost {
        /// Path-steps of the pilot.
        pilot_cost: u64,
        /// Path-steps allowed.
        max_cost: u64,
    },
    /// A level cannot be run.
    Ladder(LadderError),
    /// Almost every path of a level failed, so there is no estimate on it.
    NoPaths {
        /// The level.
        level: usize,
        /// How many paths failed.
        failed: u64,
        /// The first of them.
        first: Option<PathFailure>,
    },
    /// A test function is not finite on a path whose state is.
    NotFinite {
        /// Its name.
        observable: &'static str,
        /// The level.
        level: usize,
    },
}

impl fmt::Display for MultilevelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Accuracy { accuracy } => {
                write!(f, "the accuracy must be positive and finite, got {accuracy}")
            }
            Self::NoObservable => {
                write!(f, "an expectation needs at least one test function, got none")
            }
            Self::Experiment { experiment } => {
                write!(
                    f,
                    "the experiment number must be below 2^40, since levels take the bits above, got {experiment}"
                )
            }
            Self::CoarsestSteps { steps, at_most } => {
                write!(f, "the number of coarsest steps must be from 1 to {at_most}, got {steps}")
            }
            Self::WeakOrder { weak_order } => {
                write!(f, "the weak order must be positive and finite, got {weak_order}")
            }
            Self::Pilot { pilot, at_least } => {
                write!(f, "a pilot needs at least {at_least} paths, got {pilot}")
            }
            Self::MaxLevel { max_level, at_least, at_most } => {
                write!(f, "the finest level must be from {at_least} to {at_most}, got {max_level}")
            }
            Self::PilotCost { pilot_cost, max_cost } => {
                write!(
                    f,
                    "the pilot takes {pilot_cost} path-steps, but only {max_cost} are allowed"
                )
            }
            Self::Ladder(error) => error.fmt(f),
            Self::NoPaths { level, failed, first } => {
                write!(f, "{failed} paths failed on level {level}, which leaves too few")?;
                first.iter().try_for_each(|failure| write!(f, "; {failure}"))
            }
            Self::NotFinite { observable, level } => {
                write!(
                    f,
                    "the test function {observable} is not finite on some path of level {level}"
                )
            }
        }
    }
}

impl std::error::Error for MultilevelError {}

impl From<LadderError> for MultilevelError {
    fn from(error: LadderError) -> Self {
        Self::Ladder(error)
    }
}
