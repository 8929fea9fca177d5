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
    /// Areas were asked for with an error that is not positive and finite.
    AreaErrorNotPositive {
        /// The error that was given.
        error: f64,
    },
    /// Areas were asked for over a step that is not positive and finite.
    StepNotPositive {
        /// The step that was given.
        step: f64,
    },
    /// The error that was asked for needs more terms than
    /// [`AreaMethod::MAX_TERMS`](crate::AreaMethod::MAX_TERMS).
    TooManyTerms {
        /// The number of terms that it needs, before rounding up.
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
