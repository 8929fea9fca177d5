//! Fields on the spins of a lattice.

use std::{array, fmt, sync::Arc};

use real::{Row, WIDTH};

use super::Crystal;
use crate::run_time::InTime;

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

/// Largest number of spins at which a field is looked at.
const MAX_SPINS: usize = 128;

/// Field on spins as a function of time: h(t, r), and what else acts at t = 0.
pub struct OnSpins {
    of: Arc<FieldAt>,
    scratch_rows: usize,
    /// The place of each spin, and F − h there at t = 0, where F = −∂H₀/∂s.
    spins: Vec<([f64; 3], [f64; 3])>,
}

impl OnSpins {
    /// Up to 128 spins from all parts of a crystal, where `acts` gives F at t = 0.
    pub fn new(
        of: Arc<FieldAt>,
        scratch_rows: usize,
        crystal: &Crystal,
        acts: impl Fn(usize) -> [f64; 3],
    ) -> Self {
        let sites = (0..crystal.sites()).step_by(crystal.sites().div_ceil(MAX_SPINS));
        let spins = sites.map(|site| (crystal.place(site), acts(site))).collect();
        let mut new = Self { of, scratch_rows, spins };
        let start = new.field(0.0);
        for ((_, rest), h) in new.spins.iter_mut().zip(start) {
            (0..3).for_each(|c| rest[c] -= h[c]);
        }
        new
    }

    /// h on each spin.
    fn field(&self, t: f64) -> Vec<[f64; 3]> {
        let (mut h, mut scratch) = ([[0.0; WIDTH]; 3], vec![[0.0; WIDTH]; self.scratch_rows]);
        let groups = self.spins.chunks(WIDTH).flat_map(|spins| {
            let place = |p: usize| spins[p.min(spins.len() - 1)].0;
            (self.of)(t, &[0, 1, 2].map(|c| array::from_fn(|p| place(p)[c])), &mut h, &mut scratch);
            (0..spins.len()).map(|p| h.map(|row| row[p])).collect::<Vec<_>>()
        });
        groups.collect()
    }
}

impl InTime for OnSpins {
    /// Three rows for each spin.
    fn values(&self, times: &Row) -> Vec<Row> {
        let at = times.map(|t| self.field(t));
        let of = |(k, c): (usize, usize)| at.each_ref().map(|h| self.spins[k].1[c] + h[k][c]);
        (0..self.spins.len()).flat_map(|k| [0, 1, 2].map(|c| (k, c))).map(of).collect()
    }
}
