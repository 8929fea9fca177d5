//! What is asked of a comparison.

use mc::{LadderError, Observe};
use noise::{StreamKey, Truncation};

/// What is wanted of a comparison, and what it may cost.
#[derive(Clone, Copy)]
pub struct CompareSettings<'a> {
    /// The wanted strong error, (E|y_N − y(T)|²)^½.
    pub error: f64,
    /// Expectations that are wanted, too.
    pub expectations: Option<Expectations<'a>>,
    /// Seconds of wall time. When they are spent, what was found so far is the answer.
    pub budget_s: f64,
    /// Paths behind errors, 32 at least; more where expectations need them, and 32 where there is
    /// no time.
    pub samples: u64,
    /// How increments are truncated.
    pub truncation: Truncation,
    /// Which noise. Comparisons use the experiments from this one on, [`EXPERIMENTS`] of them.
    pub key: StreamKey,
}

/// Expectations E φ(y(T)) to be estimated by plain Monte Carlo.
#[derive(Clone, Copy)]
pub struct Expectations<'a> {
    /// The functions φ.
    pub observables: &'a [&'a dyn Observe],
    /// The wanted root-mean-square error of an estimate, bias and sampling together.
    pub accuracy: f64,
}

/// Numbers of experiments that a comparison takes.
pub const EXPERIMENTS: u64 = 3;
/// Paths without which there are no intervals.
pub(super) const LEAST_SAMPLES: u64 = 32;

/// A comparison that cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// There is no scheme to compare.
    #[error("a comparison needs at least one scheme, got none: `Candidates::all` has them all")]
    NoScheme,
    /// There is nothing whose expectation is wanted.
    #[error("expectations need at least one test function, got none: leave `expectations` out")]
    NoObservable,
    /// A number that must be positive and finite.
    #[error("the {what} must be positive and finite, got {value}")]
    NotPositive {
        /// Which.
        what: &'static str,
        /// The given value.
        value: f64,
    },
    /// Too few paths for an interval.
    #[error("the number of paths must be at least {LEAST_SAMPLES}, got {0}")]
    FewPaths(u64),
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
    /// Steps below ½ are too many.
    #[error("a final time of {t_end} needs too many steps; take one below 1e9")]
    FinalTime {
        /// The final time of the problem.
        t_end: f64,
    },
    /// A ladder of steps that is refused.
    #[error(transparent)]
    Ladder(#[from] LadderError),
}

impl CompareSettings<'_> {
    /// A strong error, on this noise: 256 paths, no expectations, a minute.
    pub fn new(error: f64, truncation: Truncation, key: StreamKey) -> Self {
        Self { error, expectations: None, budget_s: 60.0, samples: 256, truncation, key }
    }

    /// Refuses what cannot be done.
    pub(super) fn check(&self, schemes: usize) -> Result<(), CompareError> {
        let accuracy = self.expectations.map_or(1.0, |wanted| wanted.accuracy);
        let numbers = [
            ("wanted error", self.error),
            ("budget", self.budget_s),
            ("wanted accuracy", accuracy),
        ];
        let wrong = numbers.into_iter().find(|(_, value)| !(*value > 0.0 && value.is_finite()));
        match wrong {
            _ if schemes == 0 => Err(CompareError::NoScheme),
            Some((what, value)) => Err(CompareError::NotPositive { what, value }),
            None if self.samples < LEAST_SAMPLES => Err(CompareError::FewPaths(self.samples)),
            None if self.expectations.is_some_and(|wanted| wanted.observables.is_empty()) => {
                Err(CompareError::NoObservable)
            }
            None => Ok(()),
        }
    }
}
