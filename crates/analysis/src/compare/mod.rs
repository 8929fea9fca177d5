//! **Which scheme for my system?** Errors against the processor time that they cost.
//!
//! [`compare`] takes a problem, schemes and a wanted strong error. It measures errors against a
//! reference whose own error is estimated, with intervals; times the schemes; and recommends one.
//! The scheme that keeps most ([`Keeps`]: Casimirs, then the energy, then exact damping) is taken
//! unless it costs significantly more than the cheapest: more than 1.1 times as much with 95 %.
//!
//! ```
//! use mc::bind;
//! use noise::{StreamKey, Truncation};
//! use schemes::{EulerMaruyama, Heun, Sexp};
//! use systems::{Constant, Pendulum, Problem};
//! use analysis::compare::{Candidates, Choice, CompareSettings, Outcome, compare};
//!
//! let problem = Problem::new(Pendulum::new(1.0)?, Constant::new(2.0)?, [0.2, 1.0], 1.0)?;
//! // `Candidates::compiled(&problem, BuiltIn::compiled)` has all schemes; here are two of one's own.
//! let candidates = Candidates::against(bind(&problem, &Sexp))
//!     .and(bind(&problem, &Heun))
//!     .and(bind(&problem, &EulerMaruyama));
//! let key = StreamKey { seed: 1, experiment: 1 };
//! let settings = CompareSettings::new(3e-3, Truncation::new(4)?, key);
//! let comparison = compare(&mc::Problem::of(&problem), &candidates, &settings, &|_, _| ())?;
//! // Heun is of order one here, Euler–Maruyama of order ½.
//! assert_eq!(comparison.recommended(), Some("heun"));
//! println!("{comparison}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Errors.** All schemes see the same noise. An error is (E|y_N − y_ref|²)^½ at the final time,
//! with a bootstrap-t interval of 95 %. The reference is one of strong order one; its own error is
//! bounded by its differences at three step sizes and widens every interval. Points that are less
//! than four times that error are marked and not used. A scheme that reads Lévy areas has those of
//! the finest steps, which are practically exact: half of the error is asked of it.
//!
//! **Limits.** Of the reference and of every scheme, single steps are compared with the
//! coefficients of the equation as τ → 0 ([`Limit::Consistent`](crate::Limit)). One that misses
//! them converges to something else and is not recommended; a reference that misses them is named.
//!
//! **Step sizes.** A pilot of 64 paths shows from which step size on no path of a scheme fails.
//! Then the steps are halved, T/2ᵏ on 256 paths, until every scheme has an error below the wanted
//! one, or has 64 times the steps of the scheme that needs fewest, or the budget is spent; those of
//! the reference, too, until its error is an eighth of the wanted one. Errors are the same bits for
//! the same seed, unless the budget stops them; the result says whether it did
//! ([`Comparison::stopped`]). An error that was not reached is not priced; the steps that it needs
//! are extrapolated and marked. Where paths at τ and τ/2 part ([`Sampled::parts`]), no strong error
//! is predicted.
//!
//! **Budget.** Pilots may take a third of it, and errors three quarters of the rest.
//!
//! **Costs** are processor times of the block kernels on one thread (wall times where threads have
//! no clock) with their noise, and with areas where a scheme reads them; between points they are
//! interpolated in the logarithms.
//!
//! | item | job |
//! |---|---|
//! | [`compare`], [`Candidates`], [`CompareSettings`] | the call |
//! | [`Comparison`], [`Sampled`], [`Choice`] | what it says |
//! | [`Candidate`], [`Outcome`], [`Keeps`], [`ErrorPoint`] | of each scheme |

mod candidates;
mod display;
mod errors;
mod search;
mod verdict;

use std::time::Instant;

use mc::{Problem, RunError};
use serde::{Deserialize, Serialize};

pub use candidates::{Candidates, CompareSettings};
pub use errors::{ErrorPoint, Sampled};
pub use verdict::{Candidate, Choice, Keeps, Outcome};

/// Errors and costs of several schemes, and which to take.
///
/// [`Display`](std::fmt::Display) prints a table and a sentence.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// The name of the system.
    pub system: String,
    /// Dimension of the system.
    pub dimension: usize,
    /// Number of noises of the system.
    pub noises: usize,
    /// The final time.
    pub t_end: f64,
    /// Whether there is damping.
    pub damped: bool,
    /// Wanted strong error of y(T).
    pub wanted: f64,
    /// The paths behind all errors, and the reference.
    pub sampled: Sampled,
    /// Upper bound of the error of the reference, with 95 %. Every interval includes it.
    pub reference_error: f64,
    /// The schemes in the order of the candidates.
    pub candidates: Vec<Candidate>,
    /// Choice of a scheme, or why there is none.
    pub choice: Choice,
    /// Limits at which the budget stopped the comparison, if it did.
    pub stopped: Option<Stopped>,
    /// Seconds of wall time that the comparison took.
    pub wall_s: f64,
}

/// Limits at which the budget stopped a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stopped {
    /// The budget, seconds.
    pub budget_s: f64,
    /// Number of the finest steps of a scheme that were measured.
    pub steps: u64,
}

impl Comparison {
    /// Identifier of the recommended scheme, if one reaches the error.
    pub fn recommended(&self) -> Option<&str> {
        match self.choice {
            Choice::Take { scheme, .. } => Some(&self.candidates[scheme].scheme),
            _ => None,
        }
    }
}

/// Compares schemes on a problem and recommends one; see the [module](self).
///
/// `told` reports the progress now and then: the least error of a scheme so far, by the upper end
/// of its interval, and the seconds that are left at most.
///
/// # Errors
/// [`RunError`] if there is no scheme, if a setting is out of range, if the reference fails, or
/// if a step size is refused.
///
/// # Panics
/// When no thread can be started.
pub fn compare(
    problem: &Problem<'_>,
    candidates: &Candidates<'_>,
    settings: &CompareSettings,
    told: &dyn Fn(f64, f64),
) -> Result<Comparison, RunError> {
    settings.check(candidates.schemes.len(), problem.t_end)?;
    let (base, start) = (search::longest_steps(problem.t_end), Instant::now());
    search::Search { problem, settings, candidates, base, start, told }.run()
}
