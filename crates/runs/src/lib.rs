//! **Runs of scenes: paths and their statistics, and the files that show them.**
//!
//! ```
//! use casimir::mc::parts::Job;
//! use runs::Watch;
//! use scenes::{Changes, Source, Sweep};
//!
//! let text = r#"
//! [system]
//! state = ["q", "p"]
//! B = [["1"]]
//! H0 = "(q^2 + p^2)/2"
//! H = ["0.1*q"]
//! [run]
//! initial = [1, 0]
//! until = 1
//! steps = 64
//! "#;
//! let source = Source::new("oscillator.toml", text);
//! let sweep = Sweep::new(&source, &Changes::default())?;
//! let (job, watch) = (Job::here(), Watch::new(()));
//! let found = runs::ready(&sweep, runs::settle(&sweep))
//!     .and_then(|ready| runs::compute(&sweep, ready, &job, &watch))
//!     .expect("a run");
//! assert_eq!(found.results.len(), 1);
//! # Ok::<(), scenes::SceneError>(())
//! ```
//!
//! A [`run`](compute) is of a whole sweep, and [`output`] makes tables, pages and arrays of its
//! [`Outcomes`]. A [`Watch`] shows progress and ends work early.

pub mod failure;
mod large;
pub mod output;
mod run;
mod watch;

use casimir::stats::Warning;

pub use run::{Outcomes, Results, Settled, compute, ready, scheme, settle};
pub use watch::{Progress, Watch};

/// Warnings as lines.
pub fn lines_of<'a>(warnings: impl IntoIterator<Item = &'a Warning>) -> String {
    warnings.into_iter().map(|warning| format!("warning: {warning}\n")).collect()
}
