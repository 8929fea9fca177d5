//! Why a system cannot be looked at.

use std::fmt;

/// Why a system cannot be looked at.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum InspectError {
    /// It is defined hardly anywhere in the region.
    NoPoints {
        /// Points found.
        found: usize,
        /// Points needed.
        wanted: usize,
    },
    /// Its vector field or energy is NaN or infinite at a point of its domain.
    NotFinite {
        /// The point.
        at: Vec<f64>,
        /// The value.
        value: f64,
    },
}

impl fmt::Display for InspectError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoPoints { found, wanted } => write!(
                f,
                "{wanted} points where the system is defined are needed, got {found}; inspect_problem looks around y0"
            ),
            Self::NotFinite { at, value } => write!(
                f,
                "B grad H and the energy must be finite wherever check_domain agrees, got {value} at y = {at:?}"
            ),
        }
    }
}

impl std::error::Error for InspectError {}
