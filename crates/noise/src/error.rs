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
    /// [`AreaMethod::MAX_TERMS`](crate::MOST_AREA_TERMS).
    TooManyTerms {
        /// The required number of terms, before rounding up.
        terms: f64,
    },
    /// The time interval has no steps.
    StepsZero,
    /// The end of the time interval is not positive and finite.
    EndNotPositive {
        /// The given end.
        t_end: f64,
    },
    /// More dimensions, steps times noises, than
    /// [`QuasiWiener::MAX_DIMENSIONS`](crate::QuasiWiener::MAX_DIMENSIONS).
    TooManyDimensions {
        /// The given number of steps.
        steps: u64,
        /// The given number of noises.
        noises: usize,
    },
    /// The point is not one of the [`ScrambledSobol::POINTS`](crate::ScrambledSobol::POINTS) of a
    /// scramble.
    PointOutsideScramble {
        /// The given point.
        point: u64,
    },
    /// A block of points begins at a number that is not a multiple of 32.
    PointNotFirstOfBlock {
        /// The given first point.
        first_point: u64,
    },
    /// There are more or fewer rows to be written than dimensions.
    RowsNotDimensions {
        /// The given number of rows.
        rows: usize,
        /// The number of dimensions.
        dimensions: usize,
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
                let most = crate::MOST_AREA_TERMS;
                write!(
                    f,
                    "the error asked of the areas needs {terms:.3e} terms a step, more than {most}"
                )
            }
            Self::StepsZero => write!(f, "a time interval needs at least one step, got steps = 0"),
            Self::EndNotPositive { t_end } => {
                write!(f, "the end of time must be positive and finite, got {t_end}")
            }
            Self::TooManyDimensions { steps, noises } => {
                let most = crate::QuasiWiener::MAX_DIMENSIONS;
                write!(f, "{steps} steps of {noises} noises have more than {most} dimensions")
            }
            Self::PointOutsideScramble { point } => {
                write!(f, "a scramble has the points 0 to 2^32 - 1, got point {point}")
            }
            Self::PointNotFirstOfBlock { first_point } => {
                write!(f, "a block of points begins at a multiple of 32, got {first_point}")
            }
            Self::RowsNotDimensions { rows, dimensions } => {
                write!(f, "there are {dimensions} dimensions, got {rows} rows")
            }
        }
    }
}

impl std::error::Error for NoiseError {}
