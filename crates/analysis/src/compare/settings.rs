//! What is asked of a comparison.

use std::sync::Arc;

use mc::{
    RunError,
    parts::{Job, Stop},
};
use noise::{StreamKey, Truncation};

/// What is wanted of a comparison, and what it may cost.
#[derive(Clone, Debug)]
pub struct CompareSettings {
    /// The wanted strong error, (E|y_N − y(T)|²)^½.
    pub error: f64,
    /// Seconds of wall time. When they are spent, what was found so far is the answer.
    pub budget_s: f64,
    /// Paths behind errors, 32 at least; 32 where there is no time.
    pub samples: u64,
    /// How increments are truncated.
    pub truncation: Truncation,
    /// Which noise. Comparisons use this experiment and the next two.
    pub key: StreamKey,
    /// Ends the comparison early, as if the time were over.
    pub stop: Stop,
    /// Keeps errors, if there is one.
    pub job: Option<Arc<Job>>,
}

/// Paths without which there are no intervals.
pub(super) const LEAST_SAMPLES: u64 = 32;
/// From this final time on, steps below ½ are too many.
const LATEST: f64 = 1e9;

impl CompareSettings {
    /// An error, on this noise: 256 paths, a minute.
    pub fn new(error: f64, truncation: Truncation, key: StreamKey) -> Self {
        Self {
            error,
            budget_s: 60.0,
            samples: 256,
            truncation,
            key,
            stop: Stop::default(),
            job: None,
        }
    }

    /// Refuses what cannot be done.
    pub(super) fn check(&self, schemes: usize, t_end: f64) -> Result<(), RunError> {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let (samples, least) = (self.samples as f64, LEAST_SAMPLES as f64);
        RunError::unmet([
            (schemes > 0, "number of schemes", "at least one", schemes as f64),
            (positive(self.error), "wanted error", "positive and finite", self.error),
            (positive(self.budget_s), "budget", "positive and finite", self.budget_s),
            (samples >= least, "number of paths", "at least 32", samples),
            (t_end < LATEST, "final time", "below 1e9, for fewer steps", t_end),
        ])
    }
}
