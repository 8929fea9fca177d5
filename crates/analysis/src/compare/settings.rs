//! What is asked of a comparison.

use std::sync::Arc;

use mc::{
    LadderError,
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

/// A comparison that cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// A setting that is out of range.
    #[error("the {what} must be {range}, got {value}")]
    OutOfRange {
        /// Which.
        what: &'static str,
        /// What it must be.
        range: &'static str,
        /// The given value.
        value: f64,
    },
    /// The reference fails on pilot paths at every step size.
    #[error(
        "{scheme} fails on pilot paths with {steps} steps, too: {failure}; take a shorter final \
         time, or another reference"
    )]
    Reference {
        /// The reference.
        scheme: &'static str,
        /// The finest steps tried.
        steps: u64,
        /// The first failure.
        failure: String,
    },
    /// A ladder of steps that is refused.
    #[error(transparent)]
    Ladder(#[from] LadderError),
}

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
    pub(super) fn check(&self, schemes: usize, t_end: f64) -> Result<(), CompareError> {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let (samples, least) = (self.samples as f64, LEAST_SAMPLES as f64);
        let checks = [
            ("number of schemes", "at least one", schemes as f64, schemes > 0),
            ("wanted error", "positive and finite", self.error, positive(self.error)),
            ("budget", "positive and finite", self.budget_s, positive(self.budget_s)),
            ("number of paths", "at least 32", samples, samples >= least),
            ("final time", "below 1e9, for fewer steps", t_end, t_end < LATEST),
        ];
        match checks.into_iter().find(|(.., holds)| !holds) {
            Some((what, range, value, _)) => Err(CompareError::OutOfRange { what, range, value }),
            None => Ok(()),
        }
    }
}
