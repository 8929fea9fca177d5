//! The wish that a computation ends early.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

/// A flag that ends a computation at the next step. What complete groups of paths gave is kept.
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

    /// Asks for the end on Ctrl-C and on SIGTERM, which Slurm sends when the time of a job is up.
    /// A second signal ends the process at once, with exit code 130.
    ///
    /// # Errors
    /// When the process has a handler of these signals already.
    pub fn on_signals(&self) -> Result<(), ctrlc::Error> {
        let stop = self.clone();
        ctrlc::set_handler(move || {
            if stop.is_asked() {
                std::process::exit(130);
            }
            eprintln!("stopping; once more to stop without a checkpoint");
            stop.now();
        })
    }
}
