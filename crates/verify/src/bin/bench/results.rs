//! What `cargo xtask bench --json` writes.

use analysis::Spread;
use serde::Serialize;
use verify::results::Provenance;

/// Raised whenever a reader of an older version would misread a newer one.
pub const SCHEMA: u32 = 1;

/// The numbers and where they come from.
#[derive(Serialize)]
pub struct Report {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Commit, compiler, processor, command, wall time.
    pub provenance: Provenance,
    /// The numbers.
    pub speed: Speed,
}

/// How much is run, and how often.
#[derive(Clone, Copy, Serialize)]
pub struct Workload {
    /// Paths of each measurement.
    pub paths: u64,
    /// Steps of size 2⁻⁸ of each path.
    pub steps: u64,
    /// Repetitions of each measurement.
    pub repetitions: u32,
}

impl Workload {
    /// 65 536 paths of 256 steps, best of seven.
    pub const FULL: Self = Self { paths: 65_536, steps: 256, repetitions: 7 };
    /// So small that the numbers say nothing but that everything runs.
    pub const QUICK: Self = Self { paths: 256, steps: 32, repetitions: 2 };
}

/// One scheme on one system, on one thread.
#[derive(Serialize)]
pub struct SchemeRow {
    /// The system.
    pub system: &'static str,
    /// Its dimension.
    pub dimension: usize,
    /// Its number of noises.
    pub noises: usize,
    /// The scheme.
    pub scheme: &'static str,
    /// Nanoseconds for one step of one path, by [`Speed::clock`].
    pub ns_per_path_step: Spread,
    /// The same by the clock on the wall.
    pub wall_ns_per_path_step: Spread,
    /// Paths that were left out.
    pub failed: u64,
}

/// `sexp` on the rigid body with three noises, on some threads.
#[derive(Serialize)]
pub struct ThreadRow {
    /// Threads.
    pub threads: usize,
    /// Wall seconds.
    pub seconds: Spread,
    /// The best time of one thread over the best of these.
    pub speedup: f64,
}

/// `sexp` on the rigid body with three noises, on one thread, with one number growing.
#[derive(Serialize)]
pub struct GrowthRow {
    /// What grows: `samples`, `steps` or `levels`.
    pub grows: &'static str,
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

/// Everything measured.
#[derive(Serialize)]
pub struct Speed {
    /// At which size.
    pub workload: Workload,
    /// What the times of one thread are: `on-core`, the time that it spent on a core, which other
    /// processes disturb little; or `wall`, the time that passed.
    pub clock: &'static str,
    /// Instruction set that the kernels ran on.
    pub simd: &'static str,
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
