//! E[φ(y(T))] to a requested accuracy, with an interval.
//!
//! E[φ(y_L)] = E[φ(y_0)] + Σ_{l=1}^{L} E[φ(y_l) − φ(y_{l−1})], where y_l takes 2^l times the steps
//! of y_0. The two paths of a difference share their noise, so that few are needed where steps are
//! many (Giles, *Oper. Res.* 56, 2008). The sum is extrapolated to τ → 0.
//!
//! ```
//! use expectation::Expect;
//! use mc::Observable;
//! use systems::{Constant, Problem, RigidBody};
//!
//! let body = RigidBody::one_noise([1.0, 1.0, 1.0], 1.0)?;
//! let problem = Problem::new(body, Constant::new(0.0)?, [1.0, 0.5, 0.0], 1.0)?;
//! let y2 = Observable { name: "y2", function: |y: [f64; 3]| y[1] };
//! let found = Expect::new(&problem).run(&[&y2], 1e-4)?;
//!
//! // A symmetric top with noise about its axis: y₂ + iy₃ turns by a normal angle.
//! let (lower, upper) = found.estimates[0].interval();
//! let exact = 0.5 * (-0.5f64).exp();
//! assert!(found.reached() && lower < exact && exact < upper && upper - lower <= 2e-4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Points.** Each term is a mean over points of its own, in 32 independent replicates.
//! A replicate is a scramble of Sobol points with a Brownian bridge (Owen 1995): a path of few
//! steps is an integral over few normals, which they integrate with an error far below that of
//! random points, if φ is smooth. Where a scheme reads Lévy areas, which Sobol points do not give,
//! where steps and noises are very many, or on request, a replicate is a family of random streams.
//! Nothing else depends on which points there are.
//!
//! **Accuracy.** The half-width of the 95 % interval of each test function: Student's quantile over
//! the replicates (L'Ecuyer, Nakayama, Owen and Tuffin 2023; that of 98 % for random points),
//! corrected for skewness, times the standard error, and in quadrature what events that the samples
//! missed may add ([`Estimate::missed`]), plus a bound on the bias that extrapolation leaves
//! ([`Estimate::bias_bound`]). The 95 % hold for each interval alone, not for all of them together.
//!
//! **Algorithm.** A pilot on the levels 0 to 3; finer levels until the bound on the bias is half of
//! the statistical half-width and a third of the accuracy, or 1/64 of the accuracy, and the steps
//! resolve the motion; then points are doubled on the level where a path-step gains most. A level
//! that does not help is left out of the sum. Where no level helps, because paths part at any step
//! size, as those that an event ends or that do not contract, single paths of the last level are
//! taken, and a difference two levels below bounds their bias. Decisions depend on samples and
//! counted path-steps only, so the result is the same bits for any number of threads and parts.
//!
//! **What is judged.** Three things, for each test function ([`Judged`]);
//! [`reached`](Expectation::reached) is true only if all are good, and a [`Warning`] names each
//! that is not.
//! - *Variance.* N/κ samples carry the variance, with the kurtosis κ. Below thirty, or where no
//!   sample differs, the interval is widened by 3.69·R/N: without an event in N samples up to −ln
//!   0.025 of them are expected, each no larger than R, the largest that was seen. Below thirty
//!   single paths of a φ of more than two values larger events may be missing, and nobody can tell.
//!   A heavy [tail](stats::Tail) of φ in the pilot, before rounds go on until samples look light,
//!   leaves no interval below index two and no mean below one; no more is spent on such a φ.
//!   If φ is the same to the bit on every path of a level that decides, nothing is known of R.
//! - *Bias.* Three differences bound it; the observed order must not lie below ½ or half of the
//!   weak order; coarse and fine means of neighbouring levels must agree.
//! - *Resolution.* Each component of fine and coarse states must agree to half of its motion in
//!   root mean square over all coarse times, better than on the levels below, φ to 0.7 of its
//!   motion at eight of them, and φ must vary on both in the same way. The damping that the scheme
//!   reads, summed over the steps, must agree with ∫γ by quadrature, as far as its changes from
//!   step to step allow ([`DampingResolution`](mc::DampingResolution)).
//!
//! **What is assumed.** A scheme that converges to the solution with the weak order assumed, and an
//! expansion of the bias in powers of τ on the last levels. Nothing that occurs on no path of any
//! level: an event larger than all that were seen, or a jump of φ that is hidden beside a part that
//! varies smoothly. Components all count, those that φ does not read too.
//!
//! **Paths that fail** are in no mean, from their failure on; their number stands beside each
//! estimate and level, and their share times the range of φ widens the interval. Where the accuracy
//! is out of reach for that reason, the coarsest level takes more steps, if fewer paths fail on the
//! finer ones of the first levels; else it ends.
//!
//! **Without noise** there is one path, on the levels that the accuracy takes, extrapolated with
//! the order that its differences show. The interval is a bound on what extrapolation leaves.
//!
//! **Lévy areas** are drawn on fine steps and joined on coarse ones, so the coarse path of a level
//! has the law of the fine path below if the law of a drawn area is right. Its covariance given the
//! increments is exact for any number of terms (see [`Ladder::new`](mc::Ladder::new)); cumulants
//! from the fourth on are not, which no interval has been able to detect.

mod estimator;
mod extrapolation;
mod gradient;
mod judge;
mod level;
mod report;
mod resolution;
mod rules;
mod score;
mod sum;
#[cfg(test)]
mod tests;

use std::{cell::Cell, sync::Arc};

use noise::{Purpose, StreamKey, Truncation};
use schemes::{
    BuiltIn, Heun, Method, Midpoint, Nv, Scheme, SchemeError, Sexp, SexpLi, Sweep,
    run_time::Scheme as AtRunTime,
};
use systems::{Damping, Flows, Linearity, PoissonSystem, run_time};

use estimator::{Estimator, Kept};
use mc::{
    Checkpoint, Friction, Initial, Observe, Problem, RunError, Setup, bind_owned, parts::Stop,
};

pub use gradient::{Near, Nearby, SideBySide};
pub use report::{Estimate, Expectation, Judged, Level, Rate, Warning, WarningKind};
pub use report::{short, written};

/// The computation of expectations: the scheme is chosen or given, everything else may be
/// [set](ExpectSettings). See [the module](self) for the algorithm.
///
/// **Scheme.** By [`by_parts`](Self::by_parts) `nv` of weak order two ([`Nv`]), with the mean of φ
/// over both orders of the noises, which has an expansion in even powers of τ. Without flows of
/// parts `sexp-li` of weak order one ([`SexpLi`]): extrapolation makes up for the order. Where
/// neither applies to the system, or its paths fail, `sexp`; at run time also where B is constant,
/// since `sexp-li` is explicit there and its energy drifts. Any other by
/// [`with_scheme`](Self::with_scheme).
///
/// **Limits.** It ends early where the accuracy would take more path-steps than are allowed even
/// if errors fell as N^{−3/2} ([`WarningKind::OutOfReach`]).
pub struct Expect<'a> {
    candidates: Vec<Candidate<'a>>,
    settings: ExpectSettings,
    /// The parameters of derivatives.
    parameters: Vec<Nearby<'a>>,
    /// Where derivatives are by likelihood ratios, the row of the first score, and the number from
    /// which each φ is counted.
    scores: Option<(usize, Vec<f64>)>,
    /// Callback after each round with the progress.
    pub told: Box<Told<'a>>,
    /// Callback, from any thread, with the number of path-steps done since its last call.
    pub counted: Box<dyn Fn(u64) + Sync + 'a>,
    /// Checkpoint of the samples, written every few seconds and at a stop. The computation goes on
    /// from it, with the same bits, and removes it at the end.
    pub checkpoint: Option<&'a Checkpoint>,
}

/// Callback with the progress of a computation: the largest half-width so far, and the path-steps
/// done over those that it takes by this half-width.
pub type Told<'a> = dyn Fn(f64, f64) + 'a;

/// Settings of [`Expect`].
#[derive(Clone, Debug)]
pub struct ExpectSettings {
    /// The key of all points, with an experiment number below 2⁴⁰; seed 1 and experiment 0 unless
    /// set. Each level has [streams](Purpose) of its own.
    pub key: StreamKey,
    /// Truncation of increments of schemes that need it, on every level at its own step size; of
    /// order four unless set.
    pub truncation: Truncation,
    /// The weak order p of the scheme, if it is not that of the chosen one, or one; the next power
    /// of τ in its bias is then p + 1.
    pub weak_order: Option<f64>,
    /// The rate of the fastest motion, in radians or e-foldings per time, of which a step of the
    /// finest level has one at most; zero, for one that is not known, unless set.
    pub fastest: f64,
    /// Whether points are random in the place of Sobol points.
    pub random_points: bool,
    /// Steps on the coarsest level, from 1 to 2²⁴; one unless set. Schemes that truncate increments
    /// take steps below one. A level that does not help is left out in any case.
    pub coarsest_steps: u64,
    /// The finest level allowed, from 3 to 24, which has 2^`max_level` times the coarsest steps; 16
    /// unless set. Without noise the limit is 2²² steps.
    pub max_level: usize,
    /// Path-steps of all attempts together, after which the computation ends, whether the accuracy
    /// is reached or not; 10¹⁰ unless set.
    pub max_cost: u64,
    /// Flag that ends the computation early, with the estimates of the rounds before.
    pub stop: Stop,
}

impl Default for ExpectSettings {
    fn default() -> Self {
        Self {
            key: StreamKey { seed: 1, experiment: 0 },
            // Of order τ⁴.
            truncation: Truncation::new(4).unwrap_or_else(|error| unreachable!("{error}")),
            weak_order: None,
            fastest: 0.0,
            random_points: false,
            coarsest_steps: 1,
            max_level: 16,
            max_cost: 10_000_000_000,
            stop: Stop::default(),
        }
    }
}

/// A scheme with which an expectation may be computed.
struct Candidate<'a> {
    setup: Setup<'a>,
    /// The scheme with the noises in the other order: φ is averaged over both.
    mirror: Option<Arc<dyn Method + 'a>>,
    orders: Orders,
}

/// The powers of τ in an expansion of the bias.
#[derive(Clone, Copy, Debug)]
struct Orders {
    /// The weak order p.
    weak: f64,
    /// The order q of the next power.
    next: f64,
}

/// Orders of a mean over both orders of the noises.
const BOTH_ORDERS: Orders = Orders { weak: 2.0, next: 4.0 };
/// Number of times that the coarsest level doubles its steps where paths fail.
const REFINEMENTS: u32 = 8;
/// The final time up to which the coarsest steps are chosen to be below one; beyond, they are
/// refused.
const LONGEST: f64 = 4_194_304.0;

impl<'a> Expect<'a> {
    /// Expectations of a problem.
    pub fn new<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
        problem: &'a systems::Problem<S, G, D>,
    ) -> Self {
        let first = SexpLi::new(problem.system(), problem.y0()).ok();
        Self::of(problem, first.map(|first| Box::new(first) as _), Box::new(Sexp))
    }

    /// Expectations of a problem whose system has parts with flows, which cost less.
    pub fn by_parts<S: Flows<D, M>, G: Damping, const D: usize, const M: usize>(
        problem: &'a systems::Problem<S, G, D>,
    ) -> Self {
        Self::of(problem, Some(Box::new(Nv::default())), Box::new(Sexp))
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
        Self::of(problem, first.ok(), sexp)
    }

    /// The first scheme, averaged over both orders of the noises if it has them, and `sexp`.
    fn of<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
        problem: &'a systems::Problem<S, G, D>,
        first: Option<Box<dyn Scheme<S, D, M>>>,
        sexp: Box<dyn Scheme<S, D, M>>,
    ) -> Self {
        let bind = |scheme| bind_owned(problem, scheme);
        let setup = |scheme| Setup { problem: Problem::of(problem), scheme: bind(scheme) };
        let candidate = |scheme: Box<dyn Scheme<S, D, M>>| match scheme.both_orders() {
            Some([forward, backward]) => Candidate {
                setup: setup(forward),
                mirror: (M > 1).then(|| bind(backward)),
                orders: BOTH_ORDERS,
            },
            None => setup(scheme).into(),
        };
        Self::among(first.into_iter().chain([sexp]).map(candidate))
    }

    /// Expectations of a problem known at run time.
    ///
    /// # Errors
    /// [`SchemeError`] if no scheme is for the system.
    pub fn at_run_time(problem: &'a run_time::Problem) -> Result<Self, SchemeError> {
        let system = problem.system();
        let description = system.description();
        let own = |scheme: Box<dyn AtRunTime>| Setup::at_run_time(problem, scheme);
        if description.plain {
            return Ok(Self::among(vec![own(Box::new(Heun))?, own(Box::new(Midpoint))?]));
        }
        let nv = |sweep| own(Box::new(Nv { sweep })).ok().filter(|_| system.rest().is_none());
        let first = match (nv(Sweep::Forward), nv(Sweep::Backward)) {
            (Some(setup), Some(backward)) => {
                let mirror = (description.noises > 1).then_some(backward.scheme);
                Some(Candidate { setup, mirror, orders: BOTH_ORDERS })
            }
            _ if description.linearity == Linearity::Constant => None,
            _ => match SexpLi::at_run_time(system) {
                Ok(scheme) => Some(own(Box::new(scheme))?.into()),
                Err(_) => None,
            },
        };
        Ok(Self::among(first.into_iter().chain([own(Box::new(Sexp))?.into()])))
    }

    /// Expectations with one scheme, which is given with its problem and has weak order one unless
    /// that is [set](ExpectSettings::weak_order).
    ///
    /// ```
    /// use mc::{Observable, Setup};
    /// use expectation::{Expect, ExpectSettings};
    /// use schemes::Sexp;
    /// use systems::{Constant, Problem, RigidBody};
    ///
    /// let body = RigidBody::one_noise([1.0, 1.0, 1.0], 1.0)?;
    /// let problem = Problem::new(body, Constant::new(0.0)?, [1.0, 0.5, 0.0], 1.0)?;
    /// let y2 = Observable { name: "y2", function: |y: [f64; 3]| y[1] };
    /// let expect = Expect::with_scheme(Setup::of(&problem, &Sexp))
    ///     .with(ExpectSettings { random_points: true, ..Default::default() });
    /// let found = expect.run(&[&y2], 0.01)?;
    /// assert!(found.reached() && found.scheme == "sexp");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_scheme(setup: Setup<'a>) -> Self {
        Self::among([setup])
    }

    fn among(candidates: impl IntoIterator<Item: Into<Candidate<'a>>>) -> Self {
        Self {
            candidates: candidates.into_iter().map(Into::into).collect(),
            settings: ExpectSettings::default(),
            parameters: Vec::new(),
            scores: None,
            told: Box::new(|_, _| ()),
            counted: Box::new(|_| ()),
            checkpoint: None,
        }
    }

    /// Takes these settings.
    #[must_use]
    pub fn with(self, settings: ExpectSettings) -> Self {
        Self { settings, ..self }
    }

    /// Adds friction on some components.
    #[must_use]
    pub fn with_friction(mut self, friction: &'a [Friction]) -> Self {
        for candidate in &mut self.candidates {
            candidate.setup = candidate.setup.clone().with_friction(friction);
            let mirror = candidate.mirror.take();
            candidate.mirror = mirror.map(|mirror| Friction::around(mirror, friction));
        }
        self
    }

    /// Takes random initial values; `None` for the fixed one.
    #[must_use]
    pub fn starting(mut self, initial: Option<Initial<'a>>) -> Self {
        for candidate in &mut self.candidates {
            candidate.setup.problem.initial.clone_from(&initial);
        }
        self
    }

    /// E[φ(y(T))] of every φ to the half-width `accuracy`.
    ///
    /// # Errors
    /// [`RunError`] if a setting is out of range, a level cannot be run or has no paths left, φ is
    /// not finite, the checkpoint is damaged or of another computation, or it was stopped in its
    /// pilot. Reaching a limit is no error: the result says so
    /// in its [`warnings`](Expectation::warnings), and its intervals are those that were reached.
    pub fn run(
        &self,
        observables: &[&dyn Observe],
        accuracy: f64,
    ) -> Result<Expectation, RunError> {
        if self.parameters.is_empty() {
            return self.estimate(observables, accuracy);
        }
        let on_rows = self.with_slopes(observables);
        let on_rows: Vec<&dyn Observe> = on_rows.iter().map(|phi| phi as _).collect();
        let mut found = self.estimate(&on_rows, accuracy)?;
        let slopes = found.estimates.split_off(observables.len());
        let names = self.parameters.iter().map(|one| one.parameter.clone());
        let slopes = slopes.chunks(observables.len()).map(<[Estimate]>::to_vec);
        found.gradient = names.zip(slopes).collect();
        self.bound(&mut found);
        Ok(found)
    }

    /// [`Self::run`] for test functions of all rows.
    fn estimate(
        &self,
        observables: &[&dyn Observe],
        accuracy: f64,
    ) -> Result<Expectation, RunError> {
        if observables.is_empty() {
            let few = "an expectation needs at least one test function, got none";
            return Err(RunError::Setting(few.into()));
        }
        let Self { candidates, settings, checkpoint, .. } = self;
        let spent = Cell::new(0);

        let mut kept = checkpoint.map_or(Ok(None), Checkpoint::read::<Kept<'_>>)?;
        let attempts = candidates.iter().flat_map(|candidate| {
            let steps = settings.coarsest_steps.max(candidate.least_steps());
            (0..=REFINEMENTS).map(move |doubled| (candidate, steps << doubled))
        });
        let begun = kept.as_ref().map_or(0, |kept| kept.attempt);
        let mut attempts = attempts.enumerate().skip(begun).peekable();
        let mut best = None;
        while let Some((attempt, (candidate, steps))) = attempts.next() {
            let orders = settings.weak_order.map_or(candidate.orders, Orders::of);
            settings.check(accuracy, orders.weak)?;
            let estimator = Estimator::new(
                candidate,
                self,
                observables,
                accuracy,
                &spent,
                orders,
                (attempt, steps),
            );
            match estimator.expectation(kept.take()) {
                Ok((found, helps)) => {
                    let same = |(_, (other, _)): &(_, (&Candidate<'_>, _))| {
                        helps == Some(false) && std::ptr::eq(*other, candidate)
                    };
                    while attempts.next_if(same).is_some() {}
                    if attempts.peek().is_none() || helps.is_none() || found.reached() {
                        if let (Some(checkpoint), false) = (checkpoint, settings.stop.is_asked()) {
                            checkpoint.remove();
                        }
                        return Ok(found);
                    }
                    best = Some(found);
                }
                Err(RunError::NoPaths { .. } | RunError::NotFinite { .. })
                    if attempts.peek().is_some() => {}
                // The limit is for all attempts together.
                Err(error @ (RunError::PilotCost { .. } | RunError::Stopped)) => {
                    let best = best.map(|best| Expectation { cost: spent.get(), ..best });
                    return best.ok_or(error);
                }
                Err(error) => {
                    // Going on from these samples would fail again.
                    if let Some(checkpoint) = checkpoint {
                        checkpoint.remove();
                    }
                    return Err(error);
                }
            }
        }
        best.ok_or(RunError::Stopped)
    }
}

/// Whether streams are those of a level of an expectation, whose points have an order of their own.
pub fn is_level(key: StreamKey) -> bool {
    (key.experiment / Purpose::Level(0).bits()) & 31 > 0
}

impl ExpectSettings {
    fn check(&self, accuracy: f64, weak_order: f64) -> Result<(), RunError> {
        let &Self { coarsest_steps: steps, max_level, .. } = self;
        // Fourth powers of the accuracy must be numbers.
        let fourth = (1e-70..1e70).contains(&accuracy);
        // Beyond, 1/(2^p − 1) is no weight.
        let order = (1.0 / 16.0..=16.0).contains(&weak_order);
        let (few, level) = ((1..=1 << 24).contains(&steps), (3..=24).contains(&max_level));
        RunError::unmet([
            (fourth, "accuracy", "from 1e-70 to 1e70 (else scale the function)", accuracy),
            (few, "number of coarsest steps", "from 1 to 2^24", steps as f64),
            (order, "weak order", "from 1/16 to 16", weak_order),
            (level, "finest level", "from 3 to 24", max_level as f64),
        ])
    }
}

/// A scheme of weak order one.
impl<'a> From<Setup<'a>> for Candidate<'a> {
    fn from(setup: Setup<'a>) -> Self {
        Self { setup, mirror: None, orders: Orders::of(1.0) }
    }
}

impl Orders {
    /// The order of a scheme, and the next one.
    fn of(weak: f64) -> Self {
        Self { weak, next: weak + 1.0 }
    }
}

impl Candidate<'_> {
    /// The least number of steps on the coarsest level: truncation is for steps below one.
    fn least_steps(&self) -> u64 {
        let Setup { problem, scheme } = &self.setup;
        let longest = problem.t_end.ceil().min(LONGEST) as u64;
        if scheme.about().clips_increments { 2 * longest.next_power_of_two() } else { 1 }
    }
}
