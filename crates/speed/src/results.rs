//! What was measured.

use serde::{Deserialize, Serialize};

use crate::Workload;

/// Repetitions of one measurement.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// The smallest: what the work takes when nothing disturbs it.
    pub best: f64,
    /// The one in the middle.
    pub median: f64,
    /// The largest.
    pub worst: f64,
}

impl Spread {
    /// Of at least one number.
    pub(crate) fn of(mut numbers: Vec<f64>) -> Self {
        numbers.sort_by(f64::total_cmp);
        let last = numbers.len() - 1;
        Self { best: numbers[0], median: numbers[last / 2], worst: numbers[last] }
    }

    /// Every number times `factor` > 0.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self { best: self.best * factor, median: self.median * factor, worst: self.worst * factor }
    }
}

/// What the times of one thread are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Clock {
    /// Time that the thread spent on a core: other processes disturb it little.
    OnCore,
    /// Time that passed.
    Wall,
}

/// One scheme on one system, on one thread.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SchemeRow {
    /// The system.
    pub system: String,
    /// Its dimension.
    pub dimension: usize,
    /// Its number of noises.
    pub noises: usize,
    /// The scheme.
    pub scheme: String,
    /// Nanoseconds for one step of one path, by [`Speed::clock`].
    pub ns_per_path_step: Spread,
    /// The same by the clock on the wall.
    pub wall_ns_per_path_step: Spread,
    /// Paths that were left out.
    pub failed: u64,
}

/// `sexp` on the rigid body with three noises, on some threads.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ThreadRow {
    /// Threads.
    pub threads: usize,
    /// Wall seconds.
    pub seconds: Spread,
    /// The best time of one thread over the best of these.
    pub speedup: f64,
}

/// `sexp` on the rigid body with three noises, on one thread, with one number growing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GrowthRow {
    /// What grows: `samples`, `steps` or `levels`.
    pub grows: String,
    /// How large it is.
    pub value: u64,
    /// Steps that were made, over all paths and levels.
    pub path_steps: u64,
    /// Nanoseconds for one of them, by [`Speed::clock`].
    pub ns_per_path_step: Spread,
    /// Largest memory of the process during this measurement alone; absent where the system does
    /// not tell.
    pub peak_memory_mb: Option<f64>,
}

/// Everything.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Speed {
    /// At which size.
    pub workload: Workload,
    /// What the times of one thread are.
    pub clock: Clock,
    /// Instruction set that the kernels ran on.
    pub simd: String,
    /// Whether this was built without checks for debugging.
    pub optimised: bool,
    /// Processes that were running or waiting to, on average over the minute before; absent where
    /// the system does not tell.
    pub load_before: Option<f64>,
    /// Every scheme on every system.
    pub schemes: Vec<SchemeRow>,
    /// More threads.
    pub threads: Vec<ThreadRow>,
    /// More samples, steps and levels.
    pub growth: Vec<GrowthRow>,
    /// Largest memory of the process over all measurements; absent where the system does not tell.
    pub peak_memory_mb: Option<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_is_ordered_whatever_came_first() {
        let spread = Spread::of(vec![3.0, 1.0, 2.0, 5.0]);
        assert_eq!(spread, Spread { best: 1.0, median: 2.0, worst: 5.0 });
        assert_eq!(spread.scaled(2.0), Spread { best: 2.0, median: 4.0, worst: 10.0 });
        assert_eq!(Spread::of(vec![7.0]), Spread { best: 7.0, median: 7.0, worst: 7.0 });
    }
}
