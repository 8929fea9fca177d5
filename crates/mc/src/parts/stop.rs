//! The wish that a computation ends early.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
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
pub struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Asks for the end.
    pub fn now(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether the end was asked for.
    pub fn is_asked(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
