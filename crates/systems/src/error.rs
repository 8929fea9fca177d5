//! Errors of this crate.

/// An invalid parameter or initial value: what it has to be, and what was given.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct SystemError(pub String);

impl SystemError {
    /// A component of an initial value, counted from 1, that is outside of the domain.
    pub fn outside_domain(component: usize, value: f64, domain: &str) -> Self {
        Self(format!("the initial value must satisfy {domain}, got y{component} = {value}"))
    }

    /// Checks that all components of an initial value are inside the domain.
    ///
    /// # Errors
    /// [`outside_domain`](Self::outside_domain) for the first that is not.
    pub fn unless_all(
        y: &[f64],
        is_inside: impl Fn(f64) -> bool,
        domain: &str,
    ) -> Result<(), Self> {
        match y.iter().position(|&component| !is_inside(component)) {
            Some(i) => Err(Self::outside_domain(i + 1, y[i], domain)),
            None => Ok(()),
        }
    }
}

fn unless(is_valid: bool, name: &str, must: &str, value: f64) -> Result<f64, SystemError> {
    let refused = || SystemError(format!("{name} must be {must}, got {value}"));
    is_valid.then_some(value).ok_or_else(refused)
}

/// Checks that a parameter is finite.
///
/// # Errors
/// [`SystemError`] with its name otherwise.
pub fn finite(name: &str, value: f64) -> Result<f64, SystemError> {
    unless(value.is_finite(), name, "finite", value)
}

pub fn positive(name: &str, value: f64) -> Result<f64, SystemError> {
    unless(value.is_finite() && value > 0.0, name, "positive and finite", value)
}

pub fn finite_state(y0: &[f64]) -> Result<(), SystemError> {
    SystemError::unless_all(y0, f64::is_finite, "that it is finite")
}

pub fn final_time(t_end: f64) -> Result<f64, SystemError> {
    positive("the final time T", t_end)
}
