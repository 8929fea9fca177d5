//! **What a path-step costs, as a user of [`mc::Ladder`] pays for it: noise, truncation, scheme and
//! statistic.**
//!
//! [`measure`] runs every scheme on every system, then one of them on more threads, more samples,
//! more steps and more levels, and returns numbers; `cargo xtask bench` prints them. Nothing here
//! decides whether a number is good.
//!
//! ```
//! let speed = speed::measure(&speed::Workload::quick(), &|_| ())?;
//! let sexp = speed.schemes.iter().find(|row| row.system == "pendulum" && row.scheme == "sexp");
//! assert!(sexp.is_some_and(|row| row.ns_per_path_step.best > 0.0 && row.failed == 0));
//! # Ok::<(), speed::SpeedError>(())
//! ```
//!
//! | item | job |
//! |---|---|
//! | [`measure`], [`Workload`] | everything, at a size |
//! | [`Speed`]: [`SchemeRow`], [`ThreadRow`], [`GrowthRow`], [`Spread`] | what was measured |
//! | [`Visit`], [`visit_systems`], [`schemes_for`] | the systems with their start, and the schemes that make sense on one |
//! | [`peak_memory_mb`] | the largest memory of this process so far |

mod error;
mod growth;
mod last;
mod memory;
mod results;
mod rows;
mod stopwatch;
mod systems_list;
mod threads;
mod workload;

use real::Level;

pub use error::SpeedError;
pub use memory::peak_memory_mb;
pub use results::{Clock, GrowthRow, SchemeRow, Speed, Spread, ThreadRow};
pub use systems_list::{Visit, schemes_for, visit_systems};
pub use workload::Workload;

/// Measures everything; `progress` is told what comes next.
///
/// # Errors
/// [`SpeedError`] when a workload has no path or no step, or when threads cannot be started.
pub fn measure(workload: &Workload, progress: &(dyn Fn(&str) + Sync)) -> Result<Speed, SpeedError> {
    workload.check()?;
    let load_before = load();
    let growth = growth::rows(workload, progress)?;
    let schemes = rows::rows(workload, progress)?;
    let threads = threads::rows(workload, progress)?;
    Ok(Speed {
        workload: *workload,
        clock: stopwatch::CLOCK,
        simd: Level::current().name().to_owned(),
        optimised: !cfg!(debug_assertions),
        load_before,
        schemes,
        threads,
        growth,
        peak_memory_mb: peak_memory_mb(),
    })
}

/// Processes that were running or waiting to, on average over the last minute, where the system
/// tells.
fn load() -> Option<f64> {
    std::fs::read_to_string("/proc/loadavg").ok()?.split_whitespace().next()?.parse().ok()
}
