//! E[φ(y(T))] to a requested accuracy, with everything else chosen.

use std::{cell::Cell, sync::Arc};

use noise::{StreamKey, Truncation};
use schemes::{Method, Nv, Sexp, SexpLi, Sweep, run_time::SchemeError};
use systems::{Damping, Flows, Linearity, PoissonSystem, run_time};

use crate::{
    Observable, Observe, Problem, Setup, bind_owned,
    multilevel::{
        Coupling, Expectation, ExpectationSettings, MultilevelError, Orders, QuasiSettings, SoFar,
        Warning, quasi_expectation,
    },
    observable::erased,
    parts::Job,
};

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
) -> Result<Expectation, MultilevelError> {
    Expect::new(problem).run(&erased(observables), accuracy, &|_| ())
}

/// The computation of expectations: the scheme is chosen, everything else may be set.
///
/// **Scheme.** By [`by_parts`](Self::by_parts) `nv` of weak order two ([`Nv`]), with the mean of φ
/// over both orders of the noises, which has an expansion in even powers of τ. Without flows of
/// parts `sexp-li` of weak order one ([`SexpLi`]): a step of `nv` by stages costs ten times as much
/// and more, and extrapolation makes up for the order. Where neither is for the system, or its
/// paths fail, `sexp`; at run time also where B is constant, since `sexp-li` is explicit there and
/// its energy drifts.
///
/// **Points.** Scrambled Sobol points, 32 independent scrambles, with a Brownian bridge; see
/// [`multilevel`](crate::multilevel). Levels of τ, τ/2, … are added until the bound on the bias is
/// half of the statistical half-width and a third of the accuracy, or 1/64 of the accuracy; points
/// are doubled where a path-step gains most. Where paths fail on large steps, the coarsest level
/// takes more of them, unless so few fail that their share times the range of φ, which is added to
/// the half-width, leaves the accuracy within reach.
///
/// **Limits.** It ends early where the accuracy would take more path-steps than are allowed even
/// if errors fell as N^{−3/2} ([`Warning::OutOfReach`]).
///
/// What was decided is in [`Expectation::decisions`].
pub struct Expect<'a> {
    candidates: Vec<Candidate<'a>>,
    key: StreamKey,
    scrambles: u64,
    max_cost: u64,
    coarsest_steps: u64,
    watch: fn(&SoFar),
}

/// A scheme with which an expectation may be computed.
struct Candidate<'a> {
    setup: Setup<'a>,
    /// The scheme with the noises in the other order.
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
        let setup =
            |scheme| Setup { problem: Problem::of(problem), scheme: bind_owned(problem, scheme) };
        let first = SexpLi::new(problem.system(), problem.y0());
        let first = first.map(|scheme| Candidate::of_order_one(setup(Box::new(scheme))));
        Self::of(first.map_err(|error| error.to_string()), setup(Box::new(Sexp)))
    }

    /// Expectations of a problem whose system has parts with flows, which cost less.
    pub fn by_parts<S: Flows<D, M>, G: Damping, const D: usize, const M: usize>(
        problem: &'a systems::Problem<S, G, D>,
    ) -> Self {
        let sexp =
            Setup { problem: Problem::of(problem), scheme: bind_owned(problem, Box::new(Sexp)) };
        Self::of(Ok(by_parts(problem)), sexp)
    }

    /// Expectations of a problem known at run time.
    ///
    /// # Errors
    /// [`SchemeError`] if no scheme is for the system, or memory is not there.
    pub fn at_run_time(problem: &'a run_time::Problem) -> Result<Self, SchemeError> {
        let sexp = Setup::owning(problem, Box::new(Sexp))?;
        let first = match SexpLi::at_run_time(problem.system()) {
            _ if problem.system().linearity() == Linearity::Constant => {
                Err("sexp-li is explicit where B is constant".into())
            }
            Ok(scheme) => Ok(Candidate::of_order_one(Setup::owning(problem, Box::new(scheme))?)),
            Err(error) => Err(error.to_string()),
        };
        Ok(Self::of(first, sexp))
    }
}

/// `nv` with the flows of the parts.
fn by_parts<'a, S: Flows<D, M>, G: Damping, const D: usize, const M: usize>(
    problem: &'a systems::Problem<S, G, D>,
) -> Candidate<'a> {
    let of = |sweep| bind_owned(problem, Box::new(Nv::of_parts().with_sweep(sweep)));
    Candidate {
        setup: Setup { problem: Problem::of(problem), scheme: of(Sweep::Forward) },
        mirror: (M > 1).then(|| of(Sweep::Backward)),
        orders: Orders { weak: 2.0, next: 4.0 },
        reason: "nv: weak order two, with the flows of the parts".into(),
    }
}

/// How often the coarsest level takes twice as many steps where paths fail.
const REFINEMENTS: u32 = 8;

impl<'a> Expect<'a> {
    /// The first scheme where it is for the system, and `sexp`.
    fn of(first: Result<Candidate<'a>, String>, sexp: Setup<'a>) -> Self {
        let mut sexp = Candidate::of_order_one(sexp);
        let why = match &first {
            Ok(first) => format!("paths of {} fail", first.setup.scheme.id()),
            Err(refusal) => refusal.clone(),
        };
        sexp.reason = format!("{}, since {why}", sexp.reason);
        Self {
            candidates: first.into_iter().chain([sexp]).collect(),
            key: StreamKey { seed: 1, experiment: 0 },
            scrambles: 32,
            max_cost: 10_000_000_000,
            coarsest_steps: 1,
            watch: |_| (),
        }
    }

    /// Takes the points of this key; of seed 1 and experiment 0 unless set. The experiment is below
    /// 2⁴⁰.
    #[must_use]
    pub fn with_key(self, key: StreamKey) -> Self {
        Self { key, ..self }
    }

    /// Takes so many independent scrambles, at least 16; 32 unless set.
    #[must_use]
    pub fn with_scrambles(self, scrambles: u64) -> Self {
        Self { scrambles, ..self }
    }

    /// Ends with so many path-steps of all attempts together, whether the accuracy is reached or
    /// not; 10¹⁰ unless set.
    #[must_use]
    pub fn with_max_cost(self, max_cost: u64) -> Self {
        Self { max_cost, ..self }
    }

    /// Begins with so many steps on the coarsest level; one unless set. A level that does not help
    /// is left out in any case.
    #[must_use]
    pub fn with_coarsest_steps(self, coarsest_steps: u64) -> Self {
        Self { coarsest_steps, ..self }
    }

    /// Calls `watch` between two rounds of samples.
    #[must_use]
    pub fn with_watch(self, watch: fn(&SoFar)) -> Self {
        Self { watch, ..self }
    }

    /// The expectations. `progress` is called now and then, from any thread, with the number of
    /// path-steps done since.
    ///
    /// # Errors
    /// Those of [`multilevel::expectation`](crate::multilevel::expectation).
    pub fn run(
        self,
        observables: &[&dyn Observe],
        accuracy: f64,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Expectation, MultilevelError> {
        let found = self.run_in(&Job::here(), "", observables, accuracy, progress)?;
        Ok(found.unwrap_or_else(|| unreachable!("a job that computes everything has results")))
    }

    /// The same as a piece of work of a job with the name `name`, with the same bits; see
    /// [`multilevel::expectation_in`](crate::multilevel::expectation_in).
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
    ) -> Result<Option<Expectation>, MultilevelError> {
        if !(16..=1 << 20).contains(&self.scrambles) {
            let (name, allowed) = ("number of scrambles", "from 16 to 2^20");
            let value = self.scrambles as f64;
            return Err(MultilevelError::Setting { name, allowed, value });
        }
        let (mut decisions, spent, mut best) = (Vec::new(), Cell::new(0), None);
        let last = self.candidates.len() - 1;
        for (n, candidate) in self.candidates.iter().enumerate() {
            decisions.push(candidate.reason.clone());
            let mut steps = self.coarsest_steps.max(candidate.least_steps());
            for refinement in 0..=REFINEMENTS {
                let Candidate { mirror, orders, setup, .. } = candidate;
                let scrambles = self.scrambles;
                let quasi = QuasiSettings {
                    mirror: mirror.as_ref(),
                    orders: *orders,
                    scrambles,
                    spent: &spent,
                };
                let found = quasi_expectation(
                    job,
                    &format!("{name}/{} from {steps} steps", setup.scheme.id()),
                    setup,
                    &quasi,
                    observables,
                    accuracy,
                    &self.settings(candidate, steps),
                    progress,
                );
                let end = n == last && refinement == REFINEMENTS;
                let good = |found: &Expectation| {
                    let fails = |w: &Warning| matches!(w, Warning::FailedPaths { .. });
                    let stopped = found.warnings.contains(&Warning::Stopped);
                    stopped || found.reached() || !found.warnings.iter().any(fails)
                };
                match found {
                    Ok(Some(mut found)) => {
                        let mut all = decisions.clone();
                        all.append(&mut found.decisions);
                        found.decisions = all;
                        if end || good(&found) {
                            return Ok(Some(found));
                        }
                        best = Some(found);
                    }
                    Err(MultilevelError::NoPaths { .. } | MultilevelError::NotFinite { .. })
                        if !end => {}
                    // The limit is for all attempts together.
                    Err(error @ MultilevelError::PilotCost { .. }) => {
                        let best = best.map(|best| Expectation { cost: spent.get(), ..best });
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

    fn settings(&self, candidate: &Candidate<'_>, steps: u64) -> ExpectationSettings {
        let clips = candidate.setup.scheme.clips_increments();
        let truncation = if clips { clipping() } else { Truncation::none() };
        ExpectationSettings {
            weak_order: candidate.orders.weak,
            pilot: PILOT_POINTS * self.scrambles,
            max_cost: self.max_cost,
            watch: self.watch,
            ..ExpectationSettings::new(self.key, truncation, steps, candidate.coupling())
        }
    }
}

/// Points of each scramble in the pilot.
const PILOT_POINTS: u64 = 128;

impl<'a> Candidate<'a> {
    fn of_order_one(setup: Setup<'a>) -> Self {
        let reason = format!("{}: weak order one", setup.scheme.id());
        Self { setup, mirror: None, orders: Orders { weak: 1.0, next: 2.0 }, reason }
    }

    fn coupling(&self) -> Coupling {
        let several = self.setup.problem.noises > 1 && !self.setup.scheme.reads_areas();
        if several { Coupling::Antithetic } else { Coupling::Plain }
    }

    /// The least number of steps on the coarsest level: truncation is for steps below one.
    fn least_steps(&self) -> u64 {
        match self.setup.scheme.clips_increments() {
            true => 2 * (self.setup.problem.t_end.ceil() as u64).next_power_of_two(),
            false => 1,
        }
    }
}

/// The truncation of schemes that need one: of order τ⁴.
fn clipping() -> Truncation {
    Truncation::new(4).unwrap_or_else(|error| unreachable!("{error}"))
}
