//! What can be wrong with a simulation.

use std::fmt;

use crate::LadderError;

/// What can be wrong with a simulation; found before a step is taken.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SimulationError {
    /// Steps, truncation or areas are not as they must be.
    Ladder(LadderError),
    /// Every zeroth step was to be kept.
    Every,
    /// Two columns have the same name.
    Column {
        /// The name.
        name: String,
    },
    /// A recording does not end at the final time.
    Duration {
        /// Where it ends.
        recorded: f64,
        /// The final time of the problem.
        t_end: f64,
    },
    /// A scheme that reads Lévy areas was given a recording without them.
    NoAreas {
        /// The scheme.
        scheme: &'static str,
    },
}

impl fmt::Display for SimulationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ladder(error) => error.fmt(f),
            Self::Every => write!(f, "every k-th step can be kept for k of at least 1, got k = 0"),
            Self::Column { name } => {
                write!(f, "two columns are called {name:?}; the observable needs another name")
            }
            Self::Duration { recorded, t_end } => write!(
                f,
                "the recorded increments must end at the final time T = {t_end} of the problem, got {recorded}"
            ),
            Self::NoAreas { scheme } => write!(
                f,
                "{scheme} reads Levy areas: the recording must have the columns A12, A13, ..., got increments alone"
            ),
        }
    }
}

impl std::error::Error for SimulationError {}

impl From<LadderError> for SimulationError {
    fn from(error: LadderError) -> Self {
        Self::Ladder(error)
    }
}
