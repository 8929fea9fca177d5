//! Errors of this crate.

use std::fmt;

/// An invalid argument for truncated increments or Lévy areas.
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
    /// The requested error of the areas is not positive and finite.
    AreaErrorNotPositive {
        /// The given error.
        error: f64,
    },
    /// The step of the areas is not positive and finite.
    StepNotPositive {
        /// The given step.
        step: f64,
    },
    /// The requested error needs more terms than
    /// [`AreaMethod::MAX_TERMS`](crate::AreaMethod::MAX_TERMS).
    TooManyTerms {
        /// The required number of terms, before rounding up.
        terms: f64,
    },
}

impl fmt::Display for NoiseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::StepOutsideUnitInterval { tau } => {
                write!(f, "truncated increments need a step size with 0 < tau < 1, got tau = {tau}")
            }
            Self::TruncationOrderZero => {
                write!(
                    f,
                    "the truncation order k must be at least 1 (the theorems ask k >= 2), got k = 0"
                )
            }
            Self::AreaErrorNotPositive { error } => {
                write!(
                    f,
                    "the root-mean-square error of an area must be positive and finite, got {error}"
                )
            }
            Self::StepNotPositive { step } => {
                write!(f, "Levy areas need a step size that is positive and finite, got {step}")
            }
            Self::TooManyTerms { terms } => {
                let most = crate::AreaMethod::MAX_TERMS;
                write!(
                    f,
                    "the error asked of the areas needs {terms:.3e} terms a step, more than {most}"
                )
            }
        }
    }
}

impl std::error::Error for NoiseError {}
