//! Errors of this crate.

use std::fmt;

/// An invalid argument for truncated increments, Lévy areas or points of quasi-Monte Carlo: which,
/// what it must be, and what it is.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseError(pub String);

impl NoiseError {
    /// Checks that an argument is positive and finite.
    pub(crate) fn unless_positive(name: &str, value: f64) -> Result<(), Self> {
        if value > 0.0 && value.is_finite() {
            return Ok(());
        }
        Err(Self(format!("{name} must be positive and finite, got {value}")))
    }
}

impl fmt::Display for NoiseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for NoiseError {}
