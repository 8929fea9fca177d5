//! The schemes that are compared, and what is asked of them.

use std::sync::Arc;

use mc::{
    RunError, bind_owned,
    parts::{Job, Stop},
};
use noise::{StreamKey, Truncation};
use schemes::{BuiltIn, Method, Scheme, SchemeError};
use systems::{PoissonSystem, Problem, run_time::Compiled};

use inspect::facts::{Form, casimirs_around};

/// Schemes to compare, the reference, and Casimirs whose laws are measured. Schemes are those on
/// the system of one problem, see [`bind`](mc::bind).
pub struct Candidates<'a> {
    pub(super) schemes: Vec<Arc<dyn Method + 'a>>,
    pub(super) reference: Arc<dyn Method + 'a>,
    /// Casimirs that the system does not name.
    pub(super) casimirs: Vec<Form>,
}

impl<'a> Candidates<'a> {
    /// Creates candidates with this reference and no scheme yet. The reference should have strong
    /// order one:
    /// [`SexpLevy`](schemes::SexpLevy), or [`Sexp`](schemes::Sexp) where noises commute.
    pub fn against(reference: Arc<dyn Method + 'a>) -> Self {
        Self { schemes: Vec::new(), reference, casimirs: Vec::new() }
    }

    /// Adds a scheme.
    #[must_use]
    pub fn and(mut self, scheme: Arc<dyn Method + 'a>) -> Self {
        self.schemes.push(scheme);
        self
    }

    /// The built-in schemes that `scheme` makes for the system: all that need no flows with
    /// [`BuiltIn::compiled`], also [`Nv`](schemes::Nv) and [`Split`](schemes::Split) with
    /// [`BuiltIn::by_parts`]; with Lévy areas only if the noises do not commute. The reference is
    /// [`SexpLevy`](schemes::SexpLevy).
    ///
    /// If the system names no invariant, the linear and quadratic Casimirs that
    /// [`Facts`](inspect::facts::Facts) have are measured.
    ///
    /// # Panics
    /// If it does not make [`Sexp`](schemes::Sexp).
    pub fn compiled<S: PoissonSystem<D, M> + Clone + 'static, G, const D: usize, const M: usize>(
        problem: &'a Problem<S, G, D>,
        scheme: impl Fn(BuiltIn, &S, [f64; D]) -> Result<Box<dyn Scheme<S, D, M>>, SchemeError>,
    ) -> Self {
        let (system, y0) = (problem.system(), problem.y0());
        let bind = |id| scheme(id, system, y0).map(|scheme| bind_owned(problem, scheme));
        let mut all = Self::built_in(bind).unwrap_or_else(|error| unreachable!("{error}"));
        if system.invariants().is_empty() {
            all.casimirs = casimirs_around(&Compiled::new(system.clone(), y0), &y0);
        }
        all
    }

    /// All [built-in schemes](BuiltIn) that `bind` makes; with Lévy areas only if it makes them and
    /// the noises do not commute.
    ///
    /// The reference is [`SexpLevy`](schemes::SexpLevy); without areas it is
    /// [`Sexp`](schemes::Sexp), which is of strong order ½ as all other schemes are, and needs many
    /// steps for an error that is small beside theirs; on matrices [`SexpLi`](schemes::SexpLi), and
    /// of equations without B and H [`HeunLevy`](schemes::HeunLevy).
    ///
    /// # Errors
    /// Those of [`Sexp`](schemes::Sexp).
    pub fn built_in(
        bind: impl Fn(BuiltIn) -> Result<Arc<dyn Method + 'a>, SchemeError>,
    ) -> Result<Self, SchemeError> {
        use BuiltIn::{Heun, HeunLevy, Sexp, SexpLevy, SexpLi};
        let reference = match bind(SexpLevy).or_else(|_| bind(Sexp)) {
            Ok(reference) => reference,
            Err(error) => {
                let mut others = [SexpLi, HeunLevy, Heun].into_iter();
                others.find_map(|id| bind(id).ok()).ok_or(error)?
            }
        };
        let mut all = Self::against(reference);
        for id in BuiltIn::ALL {
            // Without areas that it reads the same scheme is there already.
            let new =
                |scheme: &Arc<dyn Method + 'a>| !id.is_for_areas() || scheme.about().reads_areas;
            all.schemes.extend(bind(id).ok().filter(new));
        }
        Ok(all)
    }
}

/// Settings of a comparison: the wanted error, the budget, paths and noise.
#[derive(Clone, Debug)]
pub struct CompareSettings {
    /// The wanted strong error, (E|y_N − y(T)|²)^½.
    pub error: f64,
    /// Budget in seconds of wall time. When it is spent, the findings so far are the answer.
    pub budget_s: f64,
    /// Number of paths for errors, 32 at least; 32 where there is no time.
    pub samples: u64,
    /// Truncation of increments.
    pub truncation: Truncation,
    /// Key of the noise. Comparisons use this experiment and the next two.
    pub key: StreamKey,
    /// Ends the comparison early, as if the time were over.
    pub stop: Stop,
    /// Job that stores errors, if there is one.
    pub job: Option<Arc<Job>>,
}

/// Least number of paths for intervals.
pub const MIN_SAMPLES: u64 = 32;
/// Final time from which steps below ½ are too many.
const LATEST: f64 = 1e9;

impl CompareSettings {
    /// Settings for the strong `error` on the noise of `key`: 256 paths, one minute.
    pub fn new(error: f64, truncation: Truncation, key: StreamKey) -> Self {
        Self {
            error,
            budget_s: 60.0,
            samples: 256,
            truncation,
            key,
            stop: Stop::default(),
            job: None,
        }
    }

    /// Rejects settings that are out of range.
    pub(super) fn check(&self, schemes: usize, t_end: f64) -> Result<(), RunError> {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let (samples, least) = (self.samples as f64, MIN_SAMPLES as f64);
        RunError::unmet([
            (schemes > 0, "number of schemes", "at least one", schemes as f64),
            (positive(self.error), "wanted error", "positive and finite", self.error),
            (positive(self.budget_s), "budget", "positive and finite", self.budget_s),
            (samples >= least, "number of paths", "at least 32", samples),
            (t_end < LATEST, "final time", "below 1e9, for fewer steps", t_end),
        ])
    }
}
