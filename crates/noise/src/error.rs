//! Errors of this crate.

use std::fmt;

/// An invalid argument for truncated increments, Lévy areas or points of quasi-Monte Carlo.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum NoiseError {
    /// The step of truncated increments is not in (0, 1).
    StepOutsideUnitInterval {
        /// The given step.
        tau: f64,
    },
    /// The truncation order is k = 0, which would clip every increment to zero.
    TruncationOrderZero,
    /// An argument is not positive and finite.
    NotPositive {
        /// What it is.
        name: &'static str,
        /// The given value.
        value: f64,
    },
    /// The requested error needs more terms than [`MOST_AREA_TERMS`](crate::MOST_AREA_TERMS).
    TooManyTerms {
        /// The required number of terms, before rounding up.
        terms: f64,
    },
    /// More dimensions, steps times noises, than
    /// [`QuasiWiener::MAX_DIMENSIONS`](crate::QuasiWiener::MAX_DIMENSIONS).
    TooManyDimensions {
        /// The given number of steps.
        steps: u64,
        /// The given number of noises.
        noises: usize,
    },
}

impl NoiseError {
    /// Checks that an argument is positive and finite.
    pub(crate) fn unless_positive(name: &'static str, value: f64) -> Result<(), Self> {
        if value > 0.0 && value.is_finite() {
            Ok(())
        } else {
            Err(Self::NotPositive { name, value })
        }
    }
}

impl fmt::Display for NoiseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::StepOutsideUnitInterval { tau } => {
                write!(f, "truncated increments need a step size with 0 < tau < 1, got tau = {tau}")
            }
            Self::TruncationOrderZero => {
                let needs = "must be at least 1 (the theorems ask k >= 2)";
                write!(f, "the truncation order k {needs}, got k = 0")
            }
            Self::NotPositive { name, value } => {
                write!(f, "{name} must be positive and finite, got {value}")
            }
            Self::TooManyTerms { terms } => {
                let most = crate::MOST_AREA_TERMS;
                let needs = format_args!("{terms:.3e} terms a step, more than {most}");
                write!(f, "the error asked of the areas needs {needs}")
            }
            Self::TooManyDimensions { steps, noises } => {
                let most = crate::QuasiWiener::MAX_DIMENSIONS;
                write!(f, "{steps} steps of {noises} noises have more than {most} dimensions")
            }
        }
    }
}

impl std::error::Error for NoiseError {}
