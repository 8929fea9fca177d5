//! Machines beside the processor that advance many paths at once.

use std::{fmt::Debug, ops::Range};

use noise::StreamKey;
use real::Row;

use crate::{Method, Step};

/// A machine that advances many paths at once, with the bits of this processor.
///
/// A step is known to it as a [`Listing`](crate::Listing). What it does not compute, and paths on
/// which a step has no solution by plain iteration, are left to the processor.
pub trait Device: Debug + Send + Sync {
    /// The states of paths at some times; none if the machine cannot, of which it keeps the reason.
    fn advance(&self, task: &Task<'_>) -> Option<Trajectories>;

    /// Number of paths of which fewer are sooner done on the processor.
    fn fewest(&self) -> u64;

    /// Keeps the reason why paths are not computed on the machine.
    fn refuse(&self, why: &str);

    /// The reasons that were kept, each once.
    fn refused(&self) -> Vec<String>;
}

/// Paths to be advanced.
pub struct Task<'a> {
    /// The runs: schemes on levels, each on the same noise.
    pub runs: Vec<TaskRun<'a>>,
    /// Number of components.
    pub dimension: usize,
    /// Number of noises.
    pub noises: usize,
    /// Whether space-time areas are drawn beside increments.
    pub space_time: bool,
    /// Number of finest steps.
    pub finest_steps: u64,
    /// Number of levels above the finest.
    pub levels: usize,
    /// Size of the finest step.
    pub tau: f64,
    /// The streams of the increments.
    pub key: StreamKey,
    /// The paths: whole blocks of 32.
    pub paths: Range<u64>,
    /// The coarsest steps after which states are wanted, in their order.
    pub times: Vec<u64>,
    /// States of 32 paths of a run at time 0, from the number of the run and the first path.
    pub start: &'a (dyn Fn(usize, u64) -> Vec<Row> + Sync),
    /// Step number n of a level.
    pub step: &'a (dyn Fn(usize, u64) -> Step + Sync),
    /// Whether to end early.
    pub stopped: &'a (dyn Fn() -> bool + Sync),
}

/// A run of a task.
pub struct TaskRun<'a> {
    /// The scheme on the system.
    pub method: &'a dyn Method,
    /// The level of its steps.
    pub level: usize,
    /// The largest increment, in √time; infinite if increments are not clipped.
    pub bound: f64,
}

/// States of paths at some times.
pub struct Trajectories {
    /// The paths: whole blocks of 32.
    pub paths: Range<u64>,
    /// Time by time, of each run the components and the number of clipped increments so far; a
    /// number for each path.
    pub values: Vec<f64>,
    /// Numbers of clipped increments at the end, run by run.
    pub clipped: Vec<f64>,
    /// Whether all steps of a path were computed, and all of its states are finite.
    pub solved: Vec<bool>,
}
