//! **Hard inputs: what exact mathematics says, what every scheme does, and what is guaranteed.**
//!
//! Each case runs all schemes on inputs that break numerical codes: damping factors that underflow,
//! rates that are infinite, noise past the contraction bound, states of 10¹⁵⁰, ten million steps. A
//! guarantee is a bound that is derived and stated; a row says whether it holds, whether a scheme
//! that must fail does, or that the guarantee is refuted. The fuzzer feeds arbitrary bit patterns
//! to constructors, functions and steps.
//!
//! ```
//! use stability::{Effort, Settings, case_ids, run_cases};
//!
//! let settings = Settings { seed: 1, effort: Effort::Quick };
//! let cases = run_cases(settings, &["stiff-damping".to_owned()], &|_| ());
//! let refuted = cases[0].rows.iter().filter(|row| row.verdict == stability::results::Verdict::Refuted);
//! assert!(case_ids().contains(&"stiff-damping") && refuted.count() == 0);
//! ```
//!
//! | item | job |
//! |---|---|
//! | [`run_cases`], [`case_ids`] | the hard cases |
//! | [`run_growth`] | the conformal law over 10⁷ steps |
//! | [`fuzz`] | arbitrary inputs |
//! | [`results`] | the `stability.json` contract |

mod branch;
mod cases;
pub mod fuzz;
mod growth;
mod method;
mod path;
pub mod results;
mod rounding;

pub use growth::run_growth;

use cases::{CASES, Context};
use results::Case;

/// How much is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Everything: minutes.
    Full,
    /// The same cases with fewer paths, steps and inputs: seconds.
    Quick,
}

/// What a run is told.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Master seed: the same seed gives the same bits.
    pub seed: u64,
    /// How much is tried.
    pub effort: Effort,
}

/// All cases.
#[must_use]
pub fn case_ids() -> Vec<&'static str> {
    CASES.iter().map(|entry| entry.id).collect()
}

/// Runs the cases named by `only`, or all where it is empty; names that are no case are ignored.
/// `begin` is told the name of each case.
#[must_use]
pub fn run_cases(settings: Settings, only: &[String], begin: &dyn Fn(&str)) -> Vec<Case> {
    let wanted = |id: &str| only.is_empty() || only.iter().any(|name| name == id);
    let numbered = CASES.iter().zip(0..).filter(|(entry, _)| wanted(entry.id));
    numbered
        .map(|(entry, number)| {
            begin(entry.id);
            (entry.run)(&Context {
                id: entry.id,
                number,
                seed: settings.seed,
                effort: settings.effort,
            })
        })
        .collect()
}
