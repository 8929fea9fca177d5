//! The wish that a computation ends early.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

/// Signals within this time are one wish.
const ONE_WISH: Duration = Duration::from_secs(1);

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
    /// A second signal ends the process at once, with exit code 130; not one within a second, since
    /// one wish may come as two signals.
    ///
    /// # Errors
    /// When the process has a handler of these signals already.
    pub fn on_signals(&self) -> Result<(), ctrlc::Error> {
        let (stop, mut first) = (self.clone(), None);
        ctrlc::set_handler(move || {
            let asked = *first.get_or_insert_with(Instant::now);
            if stop.is_asked() {
                if asked.elapsed() > ONE_WISH {
                    std::process::exit(130);
                }
                return;
            }
            eprintln!("stopping; once more to stop without a checkpoint");
            stop.now();
        })
    }
}
