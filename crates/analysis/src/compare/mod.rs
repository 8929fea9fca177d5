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
//! // `Candidates::compiled(&problem, BuiltIn::compiled)` has all schemes; here are two.
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
//! **Ladder of step counts.** Every scheme runs 256 paths with N₀, 2N₀, 4N₀, … steps, all on the
//! same noise; N₀ is the first number at which none of 64 paths of it fails. A scheme that has the
//! wanted error gets no finer steps. The ladder ends when all have it, six halvings after the first
//! one has it, or when the budget is spent: [`Comparison::stopped`]. The steps of the reference are
//! halved with them until its error is an eighth of the wanted one; its differences have to fall
//! unless they are below 10⁻³ of the wanted error, as rounding errors may be. Errors are the
//! same bits for the same seed, unless the budget stops them. An error that was not reached is not
//! priced; the steps that it needs are extrapolated and marked. Where paths at τ and τ/2 part
//! ([`Sampled::parts`]), no strong error is predicted.
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
mod ladder;
mod verdict;

use serde::{Deserialize, Serialize};

use crate::Spread;
pub use candidates::{Candidates, CompareSettings};
pub use ladder::compare;
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

/// The error of one scheme at one step size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorPoint {
    /// Number of steps of a path.
    pub steps: u64,
    /// Strong error (E|y_N − y_ref|²)^½.
    pub error: f64,
    /// Lower end of the 95 % interval of `error`, less the error of the reference.
    pub lo: f64,
    /// Upper end of the interval, with the error of the reference added.
    pub hi: f64,
    /// Whether the error of the reference is at most a quarter of `error`.
    pub resolved: bool,
    /// Defect (E max_C|C(y_N)/(e^{−p∫γ}C(y₀)) − 1|²)^½ over the Casimirs C; `None` if no Casimir is
    /// known.
    pub defect: Option<f64>,
    /// Seconds of processor time of a path, where they were measured.
    pub time: Option<Spread>,
}

impl ErrorPoint {
    /// Whether the point is used for a wanted error: its error is resolved, or its upper end is no
    /// larger than that.
    fn counts(&self, wanted: f64) -> bool {
        self.resolved || self.hi <= wanted
    }
}

/// Paths behind all errors, and the reference.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sampled {
    /// Number of paths.
    pub samples: u64,
    /// Number of paths left out because some scheme at some step size had no solution.
    pub failed: u64,
    /// Messages of the first few failures.
    pub failures: Vec<String>,
    /// Identifier of the reference scheme.
    pub reference: String,
    /// Number of steps of the reference.
    pub steps: u64,
    /// Strong difference (E|y_τ − y_{2τ}|²)^½ of the reference at its finest two step sizes.
    pub last_difference: f64,
    /// Distance (E|y(T) − y′(T)|²)^½ of two independent paths of the reference.
    pub spread: f64,
}

impl Sampled {
    /// Whether paths of the reference separate: at its finest two step sizes they are nearly as far
    /// apart as independent ones.
    pub fn parts(&self) -> bool {
        const PARTED: f64 = 0.25;
        self.last_difference > PARTED * self.spread
    }
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
