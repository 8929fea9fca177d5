//! The problems, and how each is measured.

use std::fmt;

use lab::Compiled;
use mc::{Ladder, Observable, Run};
use noise::{StreamKey, Truncation};
use real::elementary::{cos, sin};
use schemes::{Midpoint, Scheme, Sexp, SexpLevy};
use stats::{Moments, root_mean_square_interval};
use systems::{
    Constant, Cosine, Damping, IntegerExponents, LotkaVolterra, MaxwellBloch, Pendulum, Poisson3,
    Problem, RigidBody, Sine, SystemError,
};
use verify::{Progress, Settings, rigid_body_expectations};

use crate::clock::CLOCK;
use crate::compare::costs;
use crate::cost::Course;
use crate::ends::{Ends, Sight, Sums};
use crate::own_areas::{OwnAreas, terms};
use crate::plan::Plan;
use crate::results::{
    Case, Measurements, Provenance, SCHEMA, Strong, StrongPoint, StrongSeries, Time, Weak,
    WeakObservable, WeakPoint, WeakSeries,
};

/// One problem by its name.
struct Entry {
    id: &'static str,
    run: fn(&Context<'_>) -> Case,
}

const CASES: [Entry; 6] = [
    Entry { id: "pendulum", run: pendulum },
    Entry { id: "rigid-body-1", run: rigid_body_1 },
    Entry { id: "rigid-body-3", run: rigid_body_3 },
    Entry { id: "lotka-volterra", run: lotka_volterra },
    Entry { id: "maxwell-bloch", run: maxwell_bloch },
    Entry { id: "poisson3", run: poisson3 },
];

/// What a case is told.
struct Context<'a> {
    id: &'static str,
    settings: Settings,
    /// Number of the case, so that no two share noise.
    number: u64,
    progress: &'a dyn Progress,
}

/// Experiments of this crate count from here; those of the paper and its statements are below.
const FIRST_EXPERIMENT: u64 = 1 << 32;

impl Context<'_> {
    fn key(&self, part: u64) -> StreamKey {
        StreamKey {
            seed: self.settings.seed,
            experiment: FIRST_EXPERIMENT + 4 * self.number + part,
        }
    }
}

/// A case that does not exist.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownCase {
    /// What was asked for.
    pub id: String,
}

impl fmt::Display for UnknownCase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "there is no case {:?}; the cases are {}", self.id, case_ids().join(", "))
    }
}

impl std::error::Error for UnknownCase {}

/// All cases.
#[must_use]
pub fn case_ids() -> Vec<&'static str> {
    CASES.iter().map(|entry| entry.id).collect()
}

/// Checks that every id names a case.
///
/// # Errors
/// [`UnknownCase`] names the first that does not, and lists those that do.
pub fn check_ids(ids: &[String]) -> Result<(), UnknownCase> {
    match ids.iter().find(|id| !case_ids().contains(&id.as_str())) {
        None => Ok(()),
        Some(id) => Err(UnknownCase { id: id.clone() }),
    }
}

/// Measures the cases named by `only`, or all where it is empty: errors on the current rayon pool,
/// times on this thread.
///
/// Everything but the times is the same bits for the same seed and mode. Of the provenance only
/// seed and mode are filled in.
///
/// # Errors
/// [`UnknownCase`].
pub fn measure(
    settings: Settings,
    only: &[String],
    progress: &dyn Progress,
) -> Result<Measurements, UnknownCase> {
    check_ids(only)?;
    let cases = CASES
        .iter()
        .zip(1..)
        .filter(|(entry, _)| only.is_empty() || only.iter().any(|id| id == entry.id))
        .map(|(entry, number)| (entry.run)(&Context { id: entry.id, settings, number, progress }))
        .collect();
    let mode = match settings.mode {
        verify::Mode::Paper => "paper",
        verify::Mode::Quick => "quick",
    };
    let provenance =
        Provenance { seed: settings.seed, mode: mode.to_owned(), ..Provenance::default() };
    Ok(Measurements { schema: SCHEMA, provenance, clock: CLOCK.to_owned(), cases })
}

/// The parameters below are valid, so a constructor that refuses one is a bug here.
fn valid<T>(constructed: Result<T, SystemError>) -> T {
    constructed.unwrap_or_else(|error| unreachable!("the set-ups are valid: {error}"))
}

/// The truncation order of the reproduction.
const TRUNCATION_ORDER: u32 = 4;

fn truncation() -> Truncation {
    Truncation::new(TRUNCATION_ORDER)
        .unwrap_or_else(|error| unreachable!("the order is a positive constant: {error}"))
}

const INERTIA: [f64; 3] = [2.0, 1.0, 2.0 / 3.0];
const NOISE_INERTIA: [f64; 3] = [1.0, 2.0, 3.0];

fn rigid_body_start() -> [f64; 3] {
    [cos(1.1), 0.0, sin(1.1)]
}

fn half_cosine() -> Cosine {
    valid(Cosine::new(0.5, 2.0))
}

fn observable<const D: usize>(name: &'static str, function: fn([f64; D]) -> f64) -> Observable<D> {
    Observable { name, function }
}

/// A case in words, with its test functions and their expectations where they are known.
struct Description<const D: usize> {
    title: &'static str,
    system: &'static str,
    observables: [Observable<D>; 2],
    exact: Option<Vec<f64>>,
}

fn pendulum(context: &Context<'_>) -> Case {
    let problem =
        valid(Problem::new(valid(Pendulum::new(1.0)), valid(Constant::new(2.0)), [0.2, 1.0], 1.0));
    let description = Description {
        title: "Pendulum",
        system: "pendulum, c = 1",
        observables: [observable("y1^2", |y| y[0] * y[0]), observable("cos y2", |y| cos(y[1]))],
        exact: None,
    };
    case(context, description, &problem)
}

fn body_observables() -> [Observable<3>; 2] {
    [observable("y1^2", |y| y[0] * y[0]), observable("cos y3", |y| cos(y[2]))]
}

/// Spherical harmonics up to this degree: expectations to round-off for this body.
const DEGREE: usize = 96;

fn rigid_body_1(context: &Context<'_>) -> Case {
    let body = valid(RigidBody::one_noise(INERTIA, NOISE_INERTIA[0]));
    let problem = valid(Problem::new(body, half_cosine(), rigid_body_start(), 1.0));
    let description = Description {
        title: "Rigid body, one noise",
        system: "rigid body, only W₁, I = (2, 1, 2/3), Î₁ = 1",
        observables: body_observables(),
        exact: Some(rigid_body_expectations(&problem, DEGREE, &body_observables())),
    };
    case(context, description, &problem)
}

fn rigid_body_3(context: &Context<'_>) -> Case {
    let body = valid(RigidBody::three_noises(INERTIA, NOISE_INERTIA));
    let problem = valid(Problem::new(body, half_cosine(), rigid_body_start(), 1.0));
    let description = Description {
        title: "Rigid body, three noises",
        system: "rigid body, I = (2, 1, 2/3), Î = (1, 2, 3)",
        observables: body_observables(),
        exact: Some(rigid_body_expectations(&problem, DEGREE, &body_observables())),
    };
    case(context, description, &problem)
}

fn lotka_volterra(context: &Context<'_>) -> Case {
    let system = valid(LotkaVolterra::<IntegerExponents<1, 1>>::integer(1.0));
    let problem = valid(Problem::new(system, valid(Sine::new(1.0, 1.0)), [0.2, 0.4, 0.6], 1.0));
    let description = Description {
        title: "Lotka–Volterra",
        system: "Lotka–Volterra, a = −1, b = −1, c = 1",
        observables: [observable("y2", |y| y[1]), observable("cos y3", |y| cos(y[2]))],
        exact: None,
    };
    case(context, description, &problem)
}

fn maxwell_bloch(context: &Context<'_>) -> Case {
    // The paper shows an invariant of this system and no strong error: its system, damping and
    // start, with T = 1.
    let problem = valid(Problem::new(MaxwellBloch, half_cosine(), [1.0, 2.0, 3.0], 1.0));
    let description = Description {
        title: "Maxwell–Bloch",
        system: "Maxwell–Bloch",
        observables: [observable("y1", |y| y[0]), observable("y2^2", |y| y[1] * y[1])],
        exact: None,
    };
    case(context, description, &problem)
}

fn poisson3(context: &Context<'_>) -> Case {
    let problem =
        valid(Problem::new(valid(Poisson3::new(1.0)), half_cosine(), [1.0, 2.0, 3.0], 0.5));
    let description = Description {
        title: "Three-dimensional Poisson system",
        system: "three-dimensional Poisson system, c = 1",
        observables: [observable("y1", |y| y[0]), observable("sin y2", |y| sin(y[1]))],
        exact: None,
    };
    case(context, description, &problem)
}

/// The schemes of a case. What runs on the ladder and what is timed differ for `sexp-levy` only,
/// see [`OwnAreas`].
struct Schemes<S, const D: usize, const M: usize> {
    sexp: Box<dyn Scheme<S, D, M>>,
    /// Where it differs from `sexp`.
    levy: Option<Box<dyn Scheme<S, D, M>>>,
    own: OwnAreas<S, D, M>,
    /// `midpoint`, `heun` and `em`.
    others: [Box<dyn Scheme<S, D, M>>; 3],
}

impl<S: Compiled<D, M>, const D: usize, const M: usize> Schemes<S, D, M> {
    fn new(system: &S, y0: [f64; D]) -> Self {
        let scheme = SexpLevy::new(system, y0);
        let levy = S::sexp_levy(scheme);
        Self {
            sexp: S::sexp(Sexp::default()),
            levy: levy.needs_areas().then_some(levy),
            own: OwnAreas { levy: S::sexp_levy(scheme) },
            others: [S::midpoint(Midpoint::default()), S::heun(), S::euler_maruyama()],
        }
    }

    fn with<'a>(&'a self, levy: Option<&'a dyn Scheme<S, D, M>>) -> Vec<&'a dyn Scheme<S, D, M>> {
        let first = std::iter::once(self.sexp.as_ref()).chain(levy);
        first.chain(self.others.iter().map(AsRef::as_ref)).collect()
    }

    /// As they are timed.
    fn timed(&self) -> Vec<&dyn Scheme<S, D, M>> {
        self.with(self.levy.as_deref())
    }

    /// As their errors are measured; at the end `sexp-levy` with exact areas, where it is among
    /// them.
    fn measured(&self) -> Vec<&dyn Scheme<S, D, M>> {
        let own = self.levy.is_some().then_some(&self.own as &dyn Scheme<S, D, M>);
        let mut schemes = self.with(own);
        schemes.extend(self.levy.as_deref());
        schemes
    }

    fn reference(&self) -> &dyn Scheme<S, D, M> {
        self.levy.as_ref().unwrap_or(&self.sexp).as_ref()
    }
}

/// What a ladder has measured.
struct Errors {
    sums: Sums,
    failed: u64,
    failures: Vec<String>,
}

/// How a case is measured.
struct Bench<'a, S, G, const D: usize, const M: usize> {
    context: &'a Context<'a>,
    problem: &'a Problem<S, G, D>,
    schemes: Schemes<S, D, M>,
    plan: Plan,
    observables: [Observable<D>; 2],
}

fn case<S, G, const D: usize, const M: usize>(
    context: &Context<'_>,
    description: Description<D>,
    problem: &Problem<S, G, D>,
) -> Case
where
    S: Compiled<D, M>,
    G: Damping,
{
    let schemes = Schemes::new(&problem.system, problem.y0);
    let plan = Plan::new(context.settings.mode, schemes.levy.is_some());
    let start: Vec<String> = problem
        .y0
        .iter()
        .map(|y| format!("{y:.4}").trim_end_matches('0').trim_end_matches('.').to_owned())
        .collect();
    let setup = format!(
        "{}, {}, y₀ = ({}), T = {}, increments truncated with k = {TRUNCATION_ORDER}",
        description.system,
        problem.damping.describe(),
        start.join(", "),
        problem.t_end
    );
    let bench = Bench { context, problem, schemes, plan, observables: description.observables };
    let strong = bench.errors(false);
    let weak = bench.errors(true);
    let steps = plan.timed_steps();
    let times = bench.times(&steps);
    let time =
        |s: usize, of: u64| times[s][steps.iter().position(|&steps| steps == of).unwrap_or(0)];
    Case {
        id: context.id.to_owned(),
        title: description.title.to_owned(),
        setup,
        invariants: problem
            .system
            .invariants()
            .iter()
            .map(|invariant| invariant.name.to_owned())
            .collect(),
        strong: bench.strong(&strong, &time),
        weak: bench.weak(&weak, &time, description.exact.as_deref()),
    }
}

impl<S: Compiled<D, M>, G: Damping, const D: usize, const M: usize> Bench<'_, S, G, D, M> {
    /// Errors at the final time, on the ladder of strong or weak errors.
    fn errors(&self, weak: bool) -> Errors {
        let plan = if weak { self.plan.weak } else { self.plan.strong };
        let schemes = self.schemes.measured();
        let reference = self.schemes.reference();
        let mut runs: Vec<Run<'_, S, D, M>> = vec![Run::new(reference, 0)];
        if weak {
            runs.push(Run::new(reference, 1));
        }
        let references = runs.len();
        for scheme in &schemes {
            runs.extend(
                (plan.first..=plan.last).map(|exponent| Run::new(*scheme, plan.level(exponent))),
            );
        }
        let (problem, key) = (self.problem, self.context.key(u64::from(weak)));
        let ladder = Ladder::new(
            problem,
            1 << plan.reference,
            plan.level(plan.first),
            truncation(),
            key,
            runs,
        )
        .unwrap_or_else(|error| unreachable!("the set-ups are valid: {error}"));
        let invariants = problem.system.invariants();
        let laws: Vec<f64> = invariants
            .iter()
            .enumerate()
            .map(|(index, invariant)| {
                let decay =
                    (-invariant.degree * problem.damping.integral(0.0, problem.t_end)).exp();
                decay * problem.system.invariant(index, problem.y0)
            })
            .collect();
        let defect =
            |index: usize, y: [f64; D]| problem.system.invariant(index, y) / laws[index] - 1.0;
        let sight = Sight {
            references,
            schemes: schemes.len(),
            levels: (plan.last - plan.first + 1) as usize,
            // Defects are reported beside strong errors.
            invariants: if weak { 0 } else { laws.len() },
            defect: &defect,
            observables: if weak { &self.observables } else { &[] },
            last_time: ladder.coarse_steps(),
        };
        let name = format!("{}: {} errors", self.context.id, if weak { "weak" } else { "strong" });
        self.context.progress.begin(&name, ladder.steps_per_path() * plan.samples);
        let outcome = ladder
            .run(plan.samples, || Ends::new(sight), &|work| self.context.progress.advance(work));
        self.context.progress.end();
        Errors {
            sums: outcome.statistic.sums,
            failed: outcome.failed,
            failures: outcome.failures.iter().map(ToString::to_string).collect(),
        }
    }

    /// Times of every scheme at the given numbers of steps.
    fn times(&self, steps: &[u64]) -> Vec<Vec<Time>> {
        let Plan { repetitions, path_steps, .. } = self.plan;
        let schemes = self.schemes.timed();
        let course =
            Course { problem: self.problem, truncation: truncation(), key: self.context.key(2) };
        let work = Course::<S, G, D>::work(schemes.len(), steps, repetitions, path_steps);
        self.context.progress.begin(&format!("{}: times", self.context.id), work);
        let times = course.times(&schemes, steps, repetitions, path_steps, &|done| {
            self.context.progress.advance(done)
        });
        self.context.progress.end();
        times
    }

    /// Area terms of a scheme at a step size, where it reads areas.
    fn area_terms(&self, scheme: &dyn Scheme<S, D, M>, tau: f64) -> Option<usize> {
        scheme.needs_areas().then(|| terms(tau, M))
    }

    fn strong(&self, errors: &Errors, time: &dyn Fn(usize, u64) -> Time) -> Strong {
        let plan = self.plan.strong;
        let schemes = self.schemes.timed();
        let series = schemes.iter().enumerate().map(|(s, &scheme)| {
            let points = plan.steps().enumerate().map(|(l, steps)| {
                let tau = self.problem.t_end / steps as f64;
                let squares = errors.sums.squares(s);
                let error = squares.mean(l).sqrt();
                let (lo, hi) = root_mean_square_interval(squares, l).unzip();
                let exact = |terms| (terms, errors.sums.squares(schemes.len()).mean(l).sqrt());
                let (area_terms, error_exact_areas) =
                    self.area_terms(scheme, tau).map(exact).unzip();
                StrongPoint {
                    steps,
                    tau,
                    error,
                    se: squares.covariance_of_means(l, l).sqrt() / (2.0 * error),
                    lo,
                    hi,
                    error_exact_areas,
                    area_terms,
                    defects: errors.sums.defects(s, l),
                    time: time(s, steps),
                }
            });
            StrongSeries { scheme: scheme.id().to_owned(), points: points.collect() }
        });
        Strong {
            samples: plan.samples,
            failed: errors.failed,
            failures: errors.failures.clone(),
            reference: format!(
                "{} with {} steps on the same noise",
                self.schemes.reference().id(),
                1u64 << plan.reference
            ),
            series: series.collect(),
        }
    }

    fn weak(
        &self,
        errors: &Errors,
        time: &dyn Fn(usize, u64) -> Time,
        exact: Option<&[f64]>,
    ) -> Weak {
        let plan = self.plan.weak;
        let schemes = self.schemes.timed();
        let observables = self.observables.iter().enumerate().map(|(f, observable)| {
            let series = schemes.iter().enumerate().map(|(s, scheme)| {
                let points = plan.steps().enumerate().map(|(l, steps)| {
                    let (value, difference) = errors.sums.weak(f, s, l);
                    let tau = self.problem.t_end / steps as f64;
                    weak_point(steps, tau, value, difference, time(s, steps))
                });
                let points: Vec<WeakPoint> = points.collect();
                WeakSeries { scheme: scheme.id().to_owned(), costs: costs(&points), points }
            });
            let reference = errors.sums.reference(f);
            WeakObservable {
                name: observable.name.to_owned(),
                exact: exact.map(|exact| exact[f]),
                reference_mean: reference.mean(),
                reference_se: reference.standard_error(),
                series: series.collect(),
            }
        });
        Weak {
            samples: plan.samples,
            failed: errors.failed,
            failures: errors.failures.clone(),
            reference: format!(
                "{} extrapolated from {} and {} steps on the same noise",
                self.schemes.reference().id(),
                1u64 << (plan.reference - 1),
                1u64 << plan.reference
            ),
            observables: observables.collect(),
        }
    }
}

fn weak_point(steps: u64, tau: f64, value: Moments, difference: Moments, time: Time) -> WeakPoint {
    let standard_deviation = value.standard_error() * (value.count() as f64).sqrt();
    WeakPoint {
        steps,
        tau,
        bias: difference.mean(),
        se: difference.standard_error(),
        standard_deviation,
        time,
    }
}
