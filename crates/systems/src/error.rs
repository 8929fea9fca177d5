//! What can be wrong with a system, a damping or a problem.

use std::fmt;

/// What can be wrong with a system, a damping or a problem; found at construction.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SystemError {
    /// A parameter is NaN or infinite.
    NonFiniteParameter {
        /// Its name in the formula.
        name: &'static str,
        /// The value that was given.
        value: f64,
    },
    /// A parameter that must be positive is not.
    NonPositiveParameter {
        /// Its name in the formula.
        name: &'static str,
        /// The value that was given.
        value: f64,
    },
    /// A component of the initial value is NaN or infinite.
    NonFiniteState {
        /// Which component, counted from 1 as in the formulas.
        component: usize,
        /// The value that was given.
        value: f64,
    },
    /// A component of the initial value is where the system is not defined.
    OutsideDomain {
        /// Which component, counted from 1 as in the formulas.
        component: usize,
        /// The value that was given.
        value: f64,
        /// The domain in words.
        domain: &'static str,
    },
    /// The final time is not a positive number.
    FinalTime {
        /// The time that was given.
        t_end: f64,
    },
    /// A number of quadrature nodes out of range.
    Quadrature(dgrad::QuadratureError),
}

impl fmt::Display for SystemError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NonFiniteParameter { name, value } => {
                write!(f, "{name} must be finite, got {value}")
            }
            Self::NonPositiveParameter { name, value } => {
                write!(f, "{name} must be positive and finite, got {value}")
            }
            Self::NonFiniteState { component, value } => {
                write!(
                    f,
                    "every component of the initial value must be finite, got y{component} = {value}"
                )
            }
            Self::OutsideDomain { component, value, domain } => {
                write!(f, "the initial value must satisfy {domain}, got y{component} = {value}")
            }
            Self::FinalTime { t_end } => {
                write!(f, "the final time must be positive and finite, got T = {t_end}")
            }
            Self::Quadrature(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for SystemError {}

impl From<dgrad::QuadratureError> for SystemError {
    fn from(error: dgrad::QuadratureError) -> Self {
        Self::Quadrature(error)
    }
}

pub(crate) fn finite(name: &'static str, value: f64) -> Result<f64, SystemError> {
    if value.is_finite() { Ok(value) } else { Err(SystemError::NonFiniteParameter { name, value }) }
}

pub(crate) fn positive(name: &'static str, value: f64) -> Result<f64, SystemError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(SystemError::NonPositiveParameter { name, value })
    }
}
