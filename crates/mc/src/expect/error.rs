//! Errors of the computation of an expectation.

use crate::{LadderError, PathFailure};

/// Why there is no expectation, not even an inaccurate one.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExpectError {
    /// The accuracy or another setting is out of range.
    #[error("the {name} must be {allowed}, got {value}")]
    Setting {
        /// Its name.
        name: &'static str,
        /// The values allowed.
        allowed: &'static str,
        /// The value given.
        value: f64,
    },
    /// There is no test function.
    #[error("an expectation needs at least one test function, got none")]
    NoObservable,
    /// The pilot alone costs more path-steps than allowed; nothing was computed.
    #[error("the pilot takes {pilot_cost} path-steps, but {max_cost} are allowed")]
    PilotCost {
        /// Path-steps of the pilot.
        pilot_cost: u64,
        /// Path-steps allowed.
        max_cost: u64,
    },
    /// A level cannot be run.
    #[error(transparent)]
    Ladder(#[from] LadderError),
    /// Almost every path of a level failed, so there is no estimate on it.
    #[error(
        "{failed} paths failed on level {level}, which leaves too few{}",
        first.map_or_else(String::new, |failure| format!("; {failure}"))
    )]
    NoPaths {
        /// The level.
        level: usize,
        /// How many paths failed.
        failed: u64,
        /// The first of them.
        first: Option<PathFailure>,
    },
    /// A test function is not finite on a path whose state is.
    #[error("the test function {observable} is not finite on a path of level {level}")]
    NotFinite {
        /// Its name.
        observable: String,
        /// The level.
        level: usize,
    },
}
