//! How much is run.

use serde::{Deserialize, Serialize};

use crate::SpeedError;

/// The step size of all measurements but those that change it, 2⁻⁸.
pub(crate) const TAU: f64 = 1.0 / 256.0;

/// How much is run, and how often.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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
    #[must_use]
    pub fn full() -> Self {
        Self { paths: 65_536, steps: 256, repetitions: 7 }
    }

    /// So small that the numbers say nothing but that everything runs.
    #[must_use]
    pub fn quick() -> Self {
        Self { paths: 256, steps: 32, repetitions: 2 }
    }

    /// # Errors
    /// [`SpeedError::Empty`].
    pub(crate) fn check(&self) -> Result<(), SpeedError> {
        for (number, what) in [
            (self.paths, "paths"),
            (self.steps, "steps"),
            (u64::from(self.repetitions), "repetitions"),
        ] {
            if number == 0 {
                return Err(SpeedError::Empty { what });
            }
        }
        Ok(())
    }

    /// The final time of `steps` steps.
    pub(crate) fn t_end(&self) -> f64 {
        self.steps as f64 * TAU
    }
}
