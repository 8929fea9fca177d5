//! Errors of the computation of an expectation.

use std::fmt;

use crate::{LadderError, PathFailure};

/// Why there is no expectation, not even an inaccurate one.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum MultilevelError {
    /// The accuracy or another setting is out of range.
    Setting {
        /// Its name.
        name: &'static str,
        /// The values allowed.
        allowed: &'static str,
        /// The value given.
        value: f64,
    },
    /// There is no test function.
    NoObservable,
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
            Self::Setting { name, allowed, value } => {
                write!(f, "the {name} must be {allowed}, got {value}")
            }
            Self::NoObservable => {
                write!(f, "an expectation needs at least one test function, got none")
            }
            Self::PilotCost { pilot_cost, max_cost } => {
                write!(f, "the pilot takes {pilot_cost} path-steps, but {max_cost} are allowed")
            }
            Self::Ladder(error) => error.fmt(f),
            Self::NoPaths { level, failed, first } => {
                write!(f, "{failed} paths failed on level {level}, which leaves too few")?;
                first.iter().try_for_each(|failure| write!(f, "; {failure}"))
            }
            Self::NotFinite { observable, level } => {
                write!(f, "the test function {observable} is not finite on a path of level {level}")
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
