//! Why a system cannot be inspected.

/// Why a system cannot be inspected.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InspectError {
    /// Too few points of the region are in the domain of the system.
    #[error(
        "an inspection needs {wanted} points in the domain of the system, found {found}; with y0 it \
         searches around y0"
    )]
    NoPoints {
        /// Points found.
        found: usize,
        /// Points needed.
        wanted: usize,
    },
    /// The vector field or the energy is NaN or infinite at a point of the domain.
    #[error(
        "B grad H and the energy must be finite wherever check_domain is Ok, got {value} at \
         y = {at:?}"
    )]
    NotFinite {
        /// The point.
        at: Vec<f64>,
        /// The value.
        value: f64,
    },
}
