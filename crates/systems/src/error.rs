//! Errors of this crate.

/// An invalid parameter of a system, a damping or a problem, detected at construction.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SystemError {
    /// A parameter is NaN or infinite.
    #[error("{name} must be finite, got {value}")]
    NonFiniteParameter {
        /// The name of the parameter.
        name: &'static str,
        /// The given value.
        value: f64,
    },
    /// A parameter is not positive and finite.
    #[error("{name} must be positive and finite, got {value}")]
    NonPositiveParameter {
        /// The name of the parameter.
        name: &'static str,
        /// The given value.
        value: f64,
    },
    /// A component of the initial value is NaN or infinite.
    #[error("the initial value must be finite, got y{component} = {value}")]
    NonFiniteState {
        /// The index of the component, counted from 1.
        component: usize,
        /// The given value.
        value: f64,
    },
    /// The initial value is outside the domain of the system.
    #[error("the initial value must satisfy {domain}, got y{component} = {value}")]
    OutsideDomain {
        /// The index of the component, counted from 1.
        component: usize,
        /// The given value.
        value: f64,
        /// The condition that defines the domain.
        domain: &'static str,
    },
    /// The final time is not positive and finite.
    #[error("the final time must be positive and finite, got T = {t_end}")]
    FinalTime {
        /// The given time.
        t_end: f64,
    },
    /// The number of quadrature nodes is out of range.
    #[error(transparent)]
    Quadrature(#[from] dgrad::QuadratureError),
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
