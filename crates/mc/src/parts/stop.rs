//! The wish that a computation ends early.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

/// A flag that ends a computation at the next step. What complete groups of paths gave is kept.
///
/// Signals are the program's: a library installs no handler. With the crate `ctrlc`, and its
/// feature `termination` for SIGTERM, which Slurm sends when the time of a job is up, a program
/// ends with a checkpoint by
///
/// ```
/// # fn main() -> Result<(), ctrlc::Error> {
/// let stop = mc::parts::Stop::default();
/// let asked = stop.clone();
/// ctrlc::set_handler(move || asked.now())?;
/// // job.stopped_by(&stop)
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, Default)]
pub struct Stop {
    asked: Arc<AtomicBool>,
    end: Option<Instant>,
}

impl Stop {
    /// The same wish, which comes by itself after so many seconds from now on.
    #[must_use]
    pub fn within(&self, seconds: f64) -> Self {
        let time = Duration::try_from_secs_f64(seconds.max(0.0)).ok();
        Self { end: time.and_then(|time| Instant::now().checked_add(time)), ..self.clone() }
    }

    /// Asks for the end.
    pub fn now(&self) {
        self.asked.store(true, Ordering::Relaxed);
    }

    /// Whether the end was asked for.
    pub fn is_asked(&self) -> bool {
        self.asked.load(Ordering::Relaxed) || self.end.is_some_and(|end| end <= Instant::now())
    }
}
