//! What can be wrong with a request for noise.

use std::fmt;

/// What can be wrong with a request for noise.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum NoiseError {
    /// Truncated increments were asked for at a step where √(2k|log τ|) means nothing.
    StepOutsideUnitInterval {
        /// The step that was given.
        tau: f64,
    },
    /// The truncation order k was zero, which would clip every increment to zero.
    TruncationOrderZero,
}

impl fmt::Display for NoiseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::StepOutsideUnitInterval { tau } => {
                write!(f, "truncated increments need a step size with 0 < tau < 1, got tau = {tau}")
            }
            Self::TruncationOrderZero => {
                write!(f, "the truncation order k must be at least 1 (the theorems ask k >= 2), got k = 0")
            }
        }
    }
}

impl std::error::Error for NoiseError {}
