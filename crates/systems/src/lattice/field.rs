//! Fields on the spins of a lattice.

use std::{fmt, sync::Arc};

use real::Row;

/// Writes h at a time and 32 places into three rows.
pub type FieldAt = dyn Fn(f64, &[Row; 3], &mut [Row], &mut [Row]) + Send + Sync;

/// The field h on spins, which H₀ has as −h·s.
#[derive(Clone)]
pub enum Field {
    /// One vector for all spins at all times.
    Constant([f64; 3]),
    /// A function of time and place.
    Of {
        /// The function.
        of: Arc<FieldAt>,
        /// Whether it depends on time.
        depends_on_time: bool,
        /// Rows of scratch that it takes, at least one.
        scratch_rows: usize,
    },
}

impl From<[f64; 3]> for Field {
    fn from(h: [f64; 3]) -> Self {
        Self::Constant(h)
    }
}

impl fmt::Debug for Field {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Constant(h) => h.fmt(f),
            Self::Of { .. } => f.write_str("h(t, r)"),
        }
    }
}
