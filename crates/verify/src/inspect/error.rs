//! Why a system cannot be inspected.

use std::fmt;

/// Why a system cannot be inspected.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum InspectError {
    /// Too few points of the region are in the domain of the system.
    NoPoints {
        /// Points found.
        found: usize,
        /// Points needed.
        wanted: usize,
    },
    /// The vector field or the energy is NaN or infinite at a point of the domain.
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
                "an inspection needs {wanted} points in the domain of the system, found {found}; \
                 inspect_problem searches around y0"
            ),
            Self::NotFinite { at, value } => write!(
                f,
                "B grad H and the energy must be finite wherever check_domain is Ok, \
                 got {value} at y = {at:?}"
            ),
        }
    }
}

impl std::error::Error for InspectError {}
