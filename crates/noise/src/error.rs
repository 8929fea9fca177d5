//! Errors of this crate.

use std::fmt;

/// An invalid argument for truncated increments, Lévy areas or points of quasi-Monte Carlo.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum NoiseError {
    /// The step of truncated increments is not in (0, 1).
    StepOutsideUnitInterval {
        /// The given step.
        tau: f64,
    },
    /// Another argument. The text says which, what it must be, and what it is.
    Argument(String),
}

impl NoiseError {
    /// Checks that an argument is positive and finite.
    pub(crate) fn unless_positive(name: &str, value: f64) -> Result<(), Self> {
        if value > 0.0 && value.is_finite() {
            return Ok(());
        }
        Err(Self::Argument(format!("{name} must be positive and finite, got {value}")))
    }
}

impl fmt::Display for NoiseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::StepOutsideUnitInterval { tau } => {
                write!(f, "truncated increments need a step size with 0 < tau < 1, got tau = {tau}")
            }
            Self::Argument(text) => f.write_str(text),
        }
    }
}

impl std::error::Error for NoiseError {}
