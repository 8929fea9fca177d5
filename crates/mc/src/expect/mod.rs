//! E[φ(y(T))] to a requested accuracy, with an interval.
//!
//! E[φ(y_L)] = E[φ(y_0)] + Σ_{l=1}^{L} E[φ(y_l) − φ(y_{l−1})], where y_l takes 2^l times the steps
//! of y_0. The two paths of a difference share their noise, so that few are needed where steps are
//! many (Giles, *Oper. Res.* 56, 2008). The sum is extrapolated to τ → 0.
//!
//! **Points.** Each term is a mean over points of its own, in independent replicates, 32 unless set.
//! A replicate is a scramble of Sobol points with a Brownian bridge (Owen 1995): a path of few
//! steps is an integral over few normals, which they integrate with an error far below that of
//! random points, if φ is smooth. Where a scheme reads Lévy areas, which Sobol points do not give,
//! where steps and noises are very many, or on request, a replicate is a family of random streams.
//! Nothing else depends on which points there are.
//!
//! **Accuracy.** The half-width of the 95 % interval of each test function: Student's quantile over
//! the replicates (L'Ecuyer, Nakayama, Owen and Tuffin 2023), corrected for skewness, times the
//! standard error, and in quadrature what events that the samples missed may add
//! ([`Estimate::missed`]), plus a bound on the bias that extrapolation leaves
//! ([`Estimate::bias_bound`]). The 95 % hold for each interval alone, not for all of them together.
//!
//! **Algorithm.** A pilot on the levels 0 to 3; finer levels until the bound on the bias is half of
//! the statistical half-width and a third of the accuracy, or 1/64 of the accuracy, and the steps
//! resolve the motion; then points are doubled on the level where a path-step gains most. A level
//! that does not help is left out of the sum. Decisions depend on samples and counted path-steps
//! only, so the result is the same bits for any number of threads and parts.
//!
//! **What is judged.** Three things, for each test function ([`Judged`]);
//! [`reached`](Expectation::reached) is true only if all are good, and a [`Warning`] names each
//! that is not.
//! - *Variance.* N/κ samples carry the variance, with the kurtosis κ. Below thirty, or where no
//!   sample differs, the interval is widened by 3.69·R/N: without an event in N samples up to −ln
//!   0.025 of them are expected, each no larger than R, the largest that was seen. Below thirty
//!   single paths of a φ of more than two values, or where the largest of them fall like a power
//!   that has no variance (Hill's estimate), larger events may be missing, and nobody can tell.
//!   If φ is the same to the bit on every path of a level that decides, nothing is known of R.
//! - *Bias.* Three differences bound it; the observed order must not lie below ½ or half of the
//!   weak order; coarse and fine means of neighbouring levels must agree.
//! - *Resolution.* Each component of fine and coarse states must agree to half of its motion in
//!   root mean square over all coarse times, better than on the levels below, φ to 0.7 of its
//!   motion at eight of them, and φ must vary on both in the same way. The damping that the scheme
//!   reads, summed over the steps, must agree with ∫γ by quadrature, or converge to it
//!   ([`DampingResolution`](crate::DampingResolution)).
//!
//! **What is assumed.** A scheme that converges to the solution with the weak order assumed, and an
//! expansion of the bias in powers of τ on the last levels. Nothing that occurs on no path of any
//! level: an event larger than all that were seen, or a jump of φ that is hidden beside a part that
//! varies smoothly. Components all count, those that φ does not read too.
//!
//! **Paths that fail** are in no mean, from their failure on; their number stands beside each
//! estimate and level, and their share times the range of φ widens the interval. Where the accuracy
//! is out of reach for that reason, the coarsest level takes more steps.
//!
//! **Without noise** there is one path, on as many levels as the accuracy takes, extrapolated with
//! the order that its differences show. The interval is a bound on what extrapolation leaves.
//!
//! **Lévy areas** are drawn on fine steps and joined on coarse ones, so the coarse path of a level
//! has the law of the fine path below if the law of a drawn area is right. Its covariance given the
//! increments is exact for any number of terms (see [`Ladder::new`](crate::Ladder::new)); cumulants
//! from the fourth on are not, which no interval has been able to detect.

mod estimator;
mod extrapolation;
mod extremes;
mod judge;
mod level;
mod rates;
mod report;
mod resolution;
mod settings;
mod sum;
#[cfg(test)]
mod tests;
mod write;

use std::{cell::Cell, sync::Arc};

use noise::{StreamKey, Truncation};
use schemes::{BuiltIn, Method, Nv, Scheme, SchemeError, Sexp, SexpLi};
use systems::{Damping, Flows, Linearity, PoissonSystem, run_time};

use crate::{
    Observable, Observe, Problem, RunError, Setup, bind_owned,
    observable::{erased, value},
    parts::Job,
};
use estimator::{Asked, Estimator};
use settings::{Orders, Settings};

pub use report::{
    Estimate, Expectation, Judged, Level, LevelValue, Limit, Rate, Unbounded, Unresolved, Warning,
};
pub use settings::SoFar;

/// E[φ(y(T))] of every φ to the half-width `accuracy`: value, interval, cost and decisions.
///
/// The same as [`Expect::new`] with default settings.
///
/// ```
/// use mc::{Observable, expect};
/// use systems::{Constant, Problem, RigidBody};
///
/// let body = RigidBody::one_noise([1.0, 1.0, 1.0], 1.0)?;
/// let problem = Problem::new(body, Constant::new(0.0)?, [1.0, 0.5, 0.0], 1.0)?;
/// let y2 = [Observable { name: "y2", function: |y| y[1] }];
/// let found = expect(&problem, &y2, 1e-4)?;
///
/// // A symmetric top with noise about its axis: y₂ + iy₃ turns by a normal angle.
/// let (lower, upper) = found.estimates[0].interval();
/// let exact = 0.5 * (-0.5f64).exp();
/// assert!(found.reached() && lower < exact && exact < upper && upper - lower <= 2e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Those of [`Expect::run`].
pub fn expect<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    problem: &systems::Problem<S, G, D>,
    observables: &[Observable<D>],
    accuracy: f64,
) -> Result<Expectation, RunError> {
    Expect::new(problem).run(&erased(observables), accuracy, &|_| ())
}

/// The computation of expectations: the scheme is chosen or given, everything else may be set. See
/// [the module](self) for the algorithm.
///
/// **Scheme.** By [`by_parts`](Self::by_parts) `nv` of weak order two ([`Nv`]), with the mean of φ
/// over both orders of the noises, which has an expansion in even powers of τ. Without flows of
/// parts `sexp-li` of weak order one ([`SexpLi`]): extrapolation makes up for the order. Where
/// neither applies to the system, or its paths fail, `sexp`; at run time also where B is constant,
/// since `sexp-li` is explicit there and its energy drifts. Any other by
/// [`with_scheme`](Self::with_scheme).
///
/// **Limits.** It ends early where the accuracy would take more path-steps than are allowed even
/// if errors fell as N^{−3/2} ([`Limit::OutOfReach`]).
///
/// What was decided is in [`Expectation::decisions`].
pub struct Expect<'a> {
    candidates: Vec<Candidate<'a>>,
    settings: Settings,
}

/// A scheme with which an expectation may be computed.
struct Candidate<'a> {
    setup: Setup<'a>,
    /// The scheme with the noises in the other order: φ is averaged over both.
    mirror: Option<Arc<dyn Method + 'a>>,
    orders: Orders,
    /// Why it is this one.
    reason: String,
}

impl<'a> Expect<'a> {
    /// Expectations of a problem.
    pub fn new<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
        problem: &'a systems::Problem<S, G, D>,
    ) -> Self {
        let first = SexpLi::new(problem.system(), problem.y0());
        Self::of_schemes(problem, first.map(|first| Box::new(first) as _), Box::new(Sexp))
    }

    /// Expectations of a problem whose system has parts with flows, which cost less.
    pub fn by_parts<S: Flows<D, M>, G: Damping, const D: usize, const M: usize>(
        problem: &'a systems::Problem<S, G, D>,
    ) -> Self {
        Self::of_schemes(problem, Ok(Box::new(Nv::of_parts())), Box::new(Sexp))
    }

    /// Expectations of a problem with the schemes that `scheme` makes: [`BuiltIn::Nv`], or else
    /// [`BuiltIn::SexpLi`], and [`BuiltIn::Sexp`].
    ///
    /// # Panics
    /// If it does not make [`BuiltIn::Sexp`].
    pub fn compiled<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
        problem: &'a systems::Problem<S, G, D>,
        scheme: impl Fn(BuiltIn, &S, [f64; D]) -> Result<Box<dyn Scheme<S, D, M>>, SchemeError>,
    ) -> Self {
        let make = |id| scheme(id, problem.system(), problem.y0());
        let first = make(BuiltIn::Nv).or_else(|_| make(BuiltIn::SexpLi));
        let sexp = make(BuiltIn::Sexp).unwrap_or_else(|error| unreachable!("{error}"));
        Self::of_schemes(problem, first, sexp)
    }

    /// The first scheme, averaged over both orders of the noises if it has them, and `sexp`.
    fn of_schemes<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
        problem: &'a systems::Problem<S, G, D>,
        first: Result<Box<dyn Scheme<S, D, M>>, SchemeError>,
        sexp: Box<dyn Scheme<S, D, M>>,
    ) -> Self {
        let bind = |scheme| bind_owned(problem, scheme);
        let setup = |scheme| Setup { problem: Problem::of(problem), scheme };
        let first = first.map(|first| match first.both_orders() {
            Some([forward, backward]) => Candidate {
                setup: setup(bind(forward)),
                mirror: (M > 1).then(|| bind(backward)),
                orders: Orders { weak: 2.0, next: 4.0 },
                reason: "nv: weak order two, with the flows of the parts".into(),
            },
            None => Candidate::of_order_one(setup(bind(first))),
        });
        Self::of(first.map_err(|error| error.to_string()), setup(bind(sexp)))
    }

    /// Expectations of a problem known at run time.
    ///
    /// # Errors
    /// [`SchemeError`] if no scheme is for the system, or an allocation failed.
    pub fn at_run_time(problem: &'a run_time::Problem) -> Result<Self, SchemeError> {
        let sexp = Setup::owning(problem, Box::new(Sexp))?;
        let first = match SexpLi::at_run_time(problem.system()) {
            _ if problem.system().description().linearity == Linearity::Constant => {
                Err("sexp-li is explicit where B is constant".into())
            }
            Ok(scheme) => Ok(Candidate::of_order_one(Setup::owning(problem, Box::new(scheme))?)),
            Err(error) => Err(error.to_string()),
        };
        Ok(Self::of(first, sexp))
    }
}

/// How often the coarsest level takes twice as many steps where paths fail.
const REFINEMENTS: u32 = 8;
/// The final time up to which the coarsest steps are chosen to be below one; beyond, they are
/// refused.
const LONGEST: f64 = 4_194_304.0;

impl<'a> Expect<'a> {
    /// Expectations with one scheme, which is given with its problem and has weak order one unless
    /// [set](Self::with_weak_order).
    ///
    /// ```
    /// use mc::{Expect, Observable, Setup};
    /// use schemes::Sexp;
    /// use systems::{Constant, Problem, RigidBody};
    ///
    /// let body = RigidBody::one_noise([1.0, 1.0, 1.0], 1.0)?;
    /// let problem = Problem::new(body, Constant::new(0.0)?, [1.0, 0.5, 0.0], 1.0)?;
    /// let y2 = Observable { name: "y2", function: |y: [f64; 3]| y[1] };
    /// let expect = Expect::with_scheme(Setup::of(&problem, &Sexp)).with_random_points();
    /// let found = expect.run(&[&y2], 0.01, &|_| ())?;
    /// assert!(found.reached() && found.scheme == "sexp");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_scheme(setup: Setup<'a>) -> Self {
        let given = Candidate::of_order_one(setup);
        Self::with(vec![Candidate {
            reason: format!("{}: given", given.setup.scheme.id()),
            ..given
        }])
    }

    /// The first scheme where it is for the system, and `sexp`.
    fn of(first: Result<Candidate<'a>, String>, sexp: Setup<'a>) -> Self {
        let mut sexp = Candidate::of_order_one(sexp);
        let why = match &first {
            Ok(first) => format!("paths of {} fail", first.setup.scheme.id()),
            Err(refusal) => refusal.clone(),
        };
        sexp.reason = format!("{}, since {why}", sexp.reason);
        Self::with(first.into_iter().chain([sexp]).collect())
    }

    fn with(candidates: Vec<Candidate<'a>>) -> Self {
        // Of order τ⁴.
        let truncation = Truncation::new(4).unwrap_or_else(|error| unreachable!("{error}"));
        let settings = Settings {
            key: StreamKey { seed: 1, experiment: 0 },
            truncation,
            random_points: false,
            replicates: 32,
            coarsest_steps: 1,
            max_level: 16,
            max_cost: 10_000_000_000,
            watch: |_| (),
        };
        Self { candidates, settings }
    }

    /// Takes the points of this key; of seed 1 and experiment 0 unless set. Level l draws from the
    /// family of streams with the experiment number experiment + 2⁴⁰(l + 1), so the experiment must
    /// be below 2⁴⁰. The families of all such experiments are distinct from each other and from the
    /// experiments themselves.
    #[must_use]
    pub fn with_key(mut self, key: StreamKey) -> Self {
        self.settings.key = key;
        self
    }

    /// Truncates the increments of schemes that need it so, on every level at its own step size; of
    /// order four unless set.
    #[must_use]
    pub fn with_truncation(mut self, truncation: Truncation) -> Self {
        self.settings.truncation = truncation;
        self
    }

    /// Assumes this weak order p of the scheme, and the next power p + 1 of τ in its bias.
    #[must_use]
    pub fn with_weak_order(mut self, weak: f64) -> Self {
        let orders = Orders { weak, next: weak + 1.0 };
        self.candidates.iter_mut().for_each(|candidate| candidate.orders = orders);
        self
    }

    /// Takes random points in the place of Sobol points.
    #[must_use]
    pub fn with_random_points(mut self) -> Self {
        self.settings.random_points = true;
        self
    }

    /// Takes so many independent replicates, at least 16; 32 unless set.
    #[must_use]
    pub fn with_replicates(mut self, replicates: u64) -> Self {
        self.settings.replicates = replicates;
        self
    }

    /// Begins with so many steps on the coarsest level, from 1 to 2²⁴; one unless set. Schemes that
    /// truncate increments take steps below one. A level that does not help is left out in any
    /// case.
    #[must_use]
    pub fn with_coarsest_steps(mut self, coarsest_steps: u64) -> Self {
        self.settings.coarsest_steps = coarsest_steps;
        self
    }

    /// Takes no finer level than this, from 3 to 24, which has 2^`max_level` times the coarsest
    /// steps; 16 unless set. Without noise the limit is 2²² steps.
    #[must_use]
    pub fn with_max_level(mut self, max_level: usize) -> Self {
        self.settings.max_level = max_level;
        self
    }

    /// Ends with so many path-steps of all attempts together, whether the accuracy is reached or
    /// not; 10¹⁰ unless set.
    #[must_use]
    pub fn with_max_cost(mut self, max_cost: u64) -> Self {
        self.settings.max_cost = max_cost;
        self
    }

    /// Calls `watch` between two rounds of samples.
    #[must_use]
    pub fn with_watch(self, watch: fn(&SoFar)) -> Self {
        Self { settings: Settings { watch, ..self.settings }, ..self }
    }

    /// The expectations. `progress` is called now and then, from any thread, with the number of
    /// path-steps done since.
    ///
    /// # Errors
    /// [`RunError`] if a setting is out of range, a level cannot be run or has no paths left, or
    /// φ is not finite. Reaching a limit is no error: the result says so in its
    /// [`warnings`](Expectation::warnings), and its intervals are those that were reached.
    pub fn run(
        self,
        observables: &[&dyn Observe],
        accuracy: f64,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Expectation, RunError> {
        let found = self.run_in(&Job::here(), "", observables, accuracy, progress)?;
        Ok(found.unwrap_or_else(|| unreachable!("a job that computes everything has results")))
    }

    /// The same as [`run`](Self::run), as a piece of work of a job with the name `name`, whole, in
    /// parts or merged, with the same bits. `None` if the results are not here; [`Job::finish`]
    /// says why. A job that is stopped and [gives what is done](Job::giving_what_is_done) has the
    /// estimates of the rounds before, with [`Limit::Stopped`].
    ///
    /// Samples are drawn in rounds, and every round follows from those before: run the parts,
    /// merge, and if [`Job::finish`] reports [`NextRound`](crate::parts::JobError::NextRound), run
    /// the parts and merge again. Small rounds are not worth that, see
    /// [`Job::splitting_rounds_above`]. With a smaller accuracy in the same folder, samples that
    /// are there count.
    ///
    /// # Errors
    /// Those of [`run`](Self::run).
    pub fn run_in(
        self,
        job: &Job,
        name: &str,
        observables: &[&dyn Observe],
        accuracy: f64,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Option<Expectation>, RunError> {
        if observables.is_empty() {
            let none = "an expectation needs at least one test function, got none";
            return Err(RunError::Setting(none.into()));
        }
        let y0 = &self.candidates[0].setup.problem.y0;
        let starts = observables.iter().map(|phi| value(*phi, y0)).collect();
        let asked = Asked { job, observables, starts, accuracy, progress, spent: Cell::new(0) };
        let (mut decisions, mut best) = (Vec::new(), None);
        let last = self.candidates.len() - 1;
        for (n, candidate) in self.candidates.iter().enumerate() {
            self.settings.check(accuracy, candidate.orders.weak)?;
            decisions.push(candidate.reason.clone());
            let mut steps = self.settings.coarsest_steps.max(candidate.least_steps());
            for refinement in 0..=REFINEMENTS {
                let name = format!("{name}/{} from {steps} steps", candidate.setup.scheme.id());
                let settings = Settings { coarsest_steps: steps, ..self.settings };
                let end = n == last && refinement == REFINEMENTS;
                match Estimator::new(candidate, &asked, &name, settings).expectation() {
                    Ok(Some(mut found)) => {
                        found.decisions.splice(0..0, decisions.iter().cloned());
                        if end || found.is_final() {
                            return Ok(Some(found));
                        }
                        best = Some(found);
                    }
                    Err(RunError::NoPaths { .. } | RunError::NotFinite { .. }) if !end => {}
                    // The limit is for all attempts together.
                    Err(error @ RunError::PilotCost { .. }) => {
                        let best = best.map(|best| Expectation { cost: asked.spent.get(), ..best });
                        return best.map(Some).ok_or(error);
                    }
                    other => return other,
                }
                if refinement > 0 {
                    decisions.pop();
                }
                let taken = format!("{steps} step{}", if steps == 1 { "" } else { "s" });
                decisions.push(format!("paths fail with {taken} on the coarsest level"));
                steps *= 2;
            }
        }
        unreachable!("the last candidate returns")
    }
}

impl Expectation {
    /// Whether smaller coarsest steps would not help: no paths fail, or it is reached or stopped.
    fn is_final(&self) -> bool {
        let fails = |warning: &Warning| matches!(warning, Warning::FailedPaths { .. });
        let stopped = self.warnings.contains(&Warning::Limit(Limit::Stopped));
        stopped || self.reached() || !self.warnings.iter().any(fails)
    }
}

impl<'a> Candidate<'a> {
    fn of_order_one(setup: Setup<'a>) -> Self {
        let reason = format!("{}: weak order one", setup.scheme.id());
        Self { setup, mirror: None, orders: Orders { weak: 1.0, next: 2.0 }, reason }
    }

    /// The least number of steps on the coarsest level: truncation is for steps below one.
    fn least_steps(&self) -> u64 {
        match self.setup.scheme.clips_increments() {
            true => 2 * (self.setup.problem.t_end.ceil().min(LONGEST) as u64).next_power_of_two(),
            false => 1,
        }
    }
}
