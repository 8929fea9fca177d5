//! Errors of this crate.

/// An invalid parameter of a system, a damping or a problem, detected at construction.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SystemError {
    /// A parameter is NaN or infinite, or not positive where it has to be.
    #[error("{name} must be {must}, got {value}")]
    Parameter {
        /// The name of the parameter.
        name: &'static str,
        /// What it has to be.
        must: &'static str,
        /// The given value.
        value: f64,
    },
    /// The initial value has another number of components than the system.
    #[error("the initial value must have {dimension} components, got {components}")]
    Dimension {
        /// The dimension of the system.
        dimension: usize,
        /// The number of components given.
        components: usize,
    },
    /// The initial value is outside the domain of the system, or not finite.
    #[error("the initial value must satisfy {domain}, got y{component} = {value}")]
    OutsideDomain {
        /// The index of the component, counted from 1.
        component: usize,
        /// The given value.
        value: f64,
        /// The condition that defines the domain.
        domain: &'static str,
    },
    /// The number of quadrature nodes is out of range.
    #[error(transparent)]
    Quadrature(#[from] dgrad::QuadratureError),
}

pub(crate) fn finite(name: &'static str, value: f64) -> Result<f64, SystemError> {
    let refused = SystemError::Parameter { name, must: "finite", value };
    value.is_finite().then_some(value).ok_or(refused)
}

pub(crate) fn positive(name: &'static str, value: f64) -> Result<f64, SystemError> {
    let refused = SystemError::Parameter { name, must: "positive and finite", value };
    (value.is_finite() && value > 0.0).then_some(value).ok_or(refused)
}

/// Checks an initial value, but for its domain.
pub(crate) fn finite_state(y0: &[f64]) -> Result<(), SystemError> {
    match y0.iter().position(|component| !component.is_finite()) {
        Some(i) => Err(SystemError::OutsideDomain {
            component: i + 1,
            value: y0[i],
            domain: "that it is finite",
        }),
        None => Ok(()),
    }
}

pub(crate) fn final_time(t_end: f64) -> Result<f64, SystemError> {
    positive("the final time T", t_end)
}
