//! Why nothing was measured.

use std::fmt;

use mc::LadderError;
use systems::SystemError;

/// Why nothing was measured.
#[derive(Debug)]
#[non_exhaustive]
pub enum SpeedError {
    /// A workload without paths, steps or repetitions.
    Empty {
        /// What there is none of.
        what: &'static str,
    },
    /// A system, a damping or a start was refused.
    System(SystemError),
    /// The ladder of steps was refused.
    Ladder(LadderError),
    /// The threads could not be started.
    Threads(rayon::ThreadPoolBuildError),
}

impl fmt::Display for SpeedError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty { what } => write!(f, "a workload needs at least one of {what}, got 0"),
            Self::System(error) => error.fmt(f),
            Self::Ladder(error) => error.fmt(f),
            Self::Threads(error) => write!(f, "cannot start the threads: {error}"),
        }
    }
}

impl std::error::Error for SpeedError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Empty { .. } => None,
            // Their words are these.
            Self::System(error) => error.source(),
            Self::Ladder(error) => error.source(),
            Self::Threads(error) => Some(error),
        }
    }
}

impl From<SystemError> for SpeedError {
    fn from(error: SystemError) -> Self {
        Self::System(error)
    }
}

impl From<LadderError> for SpeedError {
    fn from(error: LadderError) -> Self {
        Self::Ladder(error)
    }
}

impl From<rayon::ThreadPoolBuildError> for SpeedError {
    fn from(error: rayon::ThreadPoolBuildError) -> Self {
        Self::Threads(error)
    }
}
