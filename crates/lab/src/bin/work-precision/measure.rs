//! Errors and times of every scheme on every problem.

use lab::setups::{Setup, Visit, visit_paper};
use lab::{TRUNCATION_ORDER, truncation};
use mc::Run;
use schemes::Scheme;
use stats::CrossMoments;
use systems::{Damping, Invariant, PoissonSystem, Problem};
use verify::results::Provenance;
use verify::work_precision::{Time, TimeError, WorkPoint};
use verify::work_precision::{ladder, path_times, squared_distance, steps};
use verify::{FinalMoments, FinalValues, Mode, Progress, Settings, StepSizes, Stopwatch};

use crate::own_areas::{OwnAreas, terms};
use crate::results::{
    Case, Cost, Kind, Measurements, SCHEMA, Sampled, Series, Strong, StrongPoint, Weak,
    WeakObservable, WeakPoint, costs,
};
use crate::sizes::{Sizes, reference_steps};

/// Measures the cases named by `only`, or all where it is empty: errors on the current rayon pool,
/// times on one thread.
///
/// Everything but the times is the same bits for the same seed and mode. Of the provenance only
/// seed, mode and threads are filled in.
pub fn measure(
    settings: Settings,
    only: &[String],
    progress: &dyn Progress,
) -> Result<Measurements, TimeError> {
    let mut cases = Cases { settings, only, progress, number: 0, measured: Vec::new() };
    visit_paper(&mut cases)?;
    let mode = match settings.mode {
        Mode::Paper => "paper",
        Mode::Quick => "quick",
    };
    let provenance = Provenance {
        seed: settings.seed,
        mode: mode.to_owned(),
        threads: rayon::current_num_threads(),
        ..Provenance::default()
    };
    let clock = if Stopwatch::MEASURES_PROCESSOR {
        "processor time of the thread"
    } else {
        "wall time, since this system does not measure the processor time of a thread"
    };
    Ok(Measurements { schema: SCHEMA, provenance, clock: clock.to_owned(), cases: cases.measured })
}

struct Cases<'a> {
    settings: Settings,
    only: &'a [String],
    progress: &'a dyn Progress,
    number: u64,
    measured: Vec<Case>,
}

impl Visit for Cases<'_> {
    type Error = TimeError;

    fn visit<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
        &mut self,
        setup: Setup<S, G, D, M>,
    ) -> Result<(), TimeError> {
        self.number += 1;
        if !self.only.is_empty() && self.only.iter().all(|id| id != setup.id) {
            return Ok(());
        }
        let timed: Vec<&dyn Scheme<S, D, M>> = setup.schemes().collect();
        let levy = timed.iter().copied().find(|scheme| scheme.reads_areas());
        let own = levy.map(|levy| OwnAreas { levy });
        let mut measured: Vec<&dyn Scheme<S, D, M>> = Vec::new();
        for &scheme in &timed {
            measured.push(match &own {
                Some(own) if scheme.reads_areas() => own,
                _ => scheme,
            });
        }
        let case = Measurement {
            progress: self.progress,
            sizes: Sizes::new(self.settings, self.number, levy.is_some()),
            reference: levy.unwrap_or(timed[0]),
            levy,
            timed,
            measured,
            setup: &setup,
        };
        self.measured.push(case.run()?);
        Ok(())
    }
}

/// One problem with its schemes.
struct Measurement<'a, S, G, const D: usize, const M: usize> {
    setup: &'a Setup<S, G, D, M>,
    progress: &'a dyn Progress,
    sizes: Sizes,
    /// The schemes as they are timed.
    timed: Vec<&'a dyn Scheme<S, D, M>>,
    /// The same as their errors are measured: see [`OwnAreas`].
    measured: Vec<&'a dyn Scheme<S, D, M>>,
    /// The scheme with exact Lévy areas, where it differs from the one without.
    levy: Option<&'a dyn Scheme<S, D, M>>,
    reference: &'a dyn Scheme<S, D, M>,
}

/// The time of a scheme, by its number, with a number of steps.
type Times<'a> = &'a dyn Fn(usize, u64) -> Time;

impl<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>
    Measurement<'_, S, G, D, M>
{
    fn run(&self) -> Result<Case, TimeError> {
        let Setup { id, title, system, problem, .. } = self.setup;
        let number =
            |y: &f64| format!("{y:.4}").trim_end_matches('0').trim_end_matches('.').to_owned();
        let setup = format!(
            "{system}, {}, y₀ = ({}), T = {}, increments truncated with k = {TRUNCATION_ORDER}",
            problem.damping.describe(),
            problem.y0.iter().map(number).collect::<Vec<_>>().join(", "),
            problem.t_end
        );
        let steps = self.sizes.timed_steps();
        let Sizes { repetitions, timed, .. } = self.sizes;
        self.progress.begin(&format!("{id}: times"), repetitions.work(self.timed.len(), &steps));
        let times =
            path_times(&self.timed, problem, &steps, truncation(), timed, repetitions, &|done| {
                self.progress.advance(done)
            })?;
        self.progress.end();
        let time = |s: usize, of: u64| {
            let place = steps.binary_search(&of);
            times[s][place.unwrap_or_else(|_| unreachable!("every number of steps is timed"))]
        };
        let invariants = problem.system.invariants();
        Ok(Case {
            id,
            title,
            setup,
            invariants: invariants.iter().map(|invariant| invariant.name.to_owned()).collect(),
            strong: self.strong(&time)?,
            weak: self.weak(&time)?,
        })
    }

    /// Moments of `length` values of the final states: those of the reference, then those of every
    /// scheme at every step size; `reference` says what it is.
    fn errors(
        &self,
        sizes: &StepSizes,
        schemes: &[&dyn Scheme<S, D, M>],
        references: usize,
        reference: &str,
        length: usize,
        values: &FinalValues<'_, D>,
    ) -> Result<(CrossMoments, Sampled), TimeError> {
        let references = (0..references).map(|level| Run::new(self.reference, level)).collect();
        let ladder = ladder(schemes, &self.setup.problem, references, sizes)?;
        let samples = sizes.samples;
        self.progress
            .begin(&format!("{}: errors", self.setup.id), ladder.steps_per_path() * samples);
        let new = || FinalMoments::new(ladder.coarse_steps(), length, values);
        let measured = ladder.run(samples, new, &|work| self.progress.advance(work));
        self.progress.end();
        let sampled = Sampled {
            samples,
            failed: measured.failed,
            failures: measured.failures.iter().map(ToString::to_string).collect(),
            reference: format!("{} {reference} on the same noise", self.reference.id()),
        };
        Ok((measured.statistic.moments().clone(), sampled))
    }

    /// A series for each scheme of the points, and costs, of its number.
    fn series<P>(&self, points: impl Fn(usize) -> (Vec<P>, Option<Vec<Cost>>)) -> Vec<Series<P>> {
        let series = |s: usize| {
            let kind = match self.timed[s] {
                _ if s == 0 => Kind::Sexp,
                scheme if scheme.reads_areas() => Kind::SexpLevy,
                _ if s < self.setup.implicit.len() => Kind::OtherImplicit,
                _ => Kind::Explicit,
            };
            let (points, costs) = points(s);
            Series { kind, scheme: self.timed[s].id(), points, costs }
        };
        (0..self.timed.len()).map(series).collect()
    }

    /// The values are squared errors of every run, then squared defects of every run and invariant.
    /// Behind the schemes stands the one with exact Lévy areas.
    fn strong(&self, time: Times<'_>) -> Result<Strong, TimeError> {
        let Problem { system, damping, y0, t_end } = &self.setup.problem;
        let law = |(index, invariant): (usize, Invariant)| {
            let decay = (-invariant.degree * damping.integral(0.0, *t_end)).exp();
            decay * system.invariant(index, *y0)
        };
        let laws: Vec<f64> = system.invariants().into_iter().enumerate().map(law).collect();
        let mut schemes = self.measured.clone();
        schemes.extend(self.levy);
        let sizes = &self.sizes.strong;
        let runs = schemes.len() * sizes.levels;
        let values = |states: &[[f64; D]], values: &mut [f64]| {
            let (squares, defects) = values.split_at_mut(runs);
            for (run, &y) in states[1..].iter().enumerate() {
                squares[run] = squared_distance(y, states[0]);
                for (index, law) in laws.iter().enumerate() {
                    let defect = system.invariant(index, y) / law - 1.0;
                    defects[run * laws.len() + index] = defect * defect;
                }
            }
        };
        let reference = format!("with {} steps", reference_steps(sizes));
        let length = runs * (1 + laws.len());
        let (moments, sampled) = self.errors(sizes, &schemes, 1, &reference, length, &values)?;
        let rms = |index: usize| moments.mean(index).sqrt();
        let point = |s: usize, l: usize, steps: u64| {
            let run = s * sizes.levels + l;
            let work = WorkPoint::new(*t_end, steps, &moments, run, time(s, steps));
            let exact = self.timed[s].reads_areas().then_some(self.timed.len() * sizes.levels + l);
            StrongPoint {
                error_exact_areas: exact.map(rms),
                area_terms: exact.map(|_| terms(work.tau, M)),
                defects: (0..laws.len()).map(|i| rms(runs + run * laws.len() + i)).collect(),
                work,
            }
        };
        let points = |s| steps(sizes).enumerate().map(move |(l, steps)| (s, l, steps));
        let points = |s| points(s).map(|(s, l, steps)| point(s, l, steps)).collect();
        Ok(Strong { sampled, series: self.series(|s| (points(s), None)) })
    }

    /// The values are, for each test function, that of the reference, and for every run its own and
    /// its difference to the reference.
    fn weak(&self, time: Times<'_>) -> Result<Weak, TimeError> {
        let (sizes, observables) = (&self.sizes.weak, &self.setup.observables);
        let each = 1 + 2 * self.measured.len() * sizes.levels;
        let values = |states: &[[f64; D]], values: &mut [f64]| {
            for (observable, values) in observables.iter().zip(values.chunks_exact_mut(each)) {
                let phi = |run: usize| (observable.function)(states[run]);
                // An error Cτ + O(τ²) of the expectation is C·2τ + O(τ²) at twice the step.
                values[0] = 2.0 * phi(0) - phi(1);
                for run in 0..states.len() - 2 {
                    values[1 + 2 * run] = phi(2 + run);
                    values[2 + 2 * run] = values[1 + 2 * run] - values[0];
                }
            }
        };
        let finest = reference_steps(sizes);
        let reference = format!("extrapolated from {} and {finest} steps", finest / 2);
        let length = observables.len() * each;
        let (moments, sampled) =
            self.errors(sizes, &self.measured, 2, &reference, length, &values)?;
        let exact = (self.setup.expectations)(&self.setup.problem, observables);
        let se = |index: usize| moments.covariance_of_means(index, index).max(0.0).sqrt();
        let observables = observables.iter().enumerate().map(|(f, observable)| {
            let first = f * each;
            let points = |s: usize| {
                let point = |(l, steps)| {
                    let value = first + 1 + 2 * (s * sizes.levels + l);
                    WeakPoint {
                        steps,
                        tau: self.setup.problem.t_end / steps as f64,
                        bias: moments.mean(value + 1),
                        se: se(value + 1),
                        standard_deviation: se(value) * (moments.count() as f64).sqrt(),
                        time: time(s, steps),
                    }
                };
                let points: Vec<WeakPoint> = steps(sizes).enumerate().map(point).collect();
                let costs = costs(&points);
                (points, Some(costs))
            };
            WeakObservable {
                name: observable.name,
                exact: exact.as_ref().map(|exact| exact[f]),
                reference_mean: moments.mean(first),
                reference_se: se(first),
                series: self.series(points),
            }
        });
        Ok(Weak { observables: observables.collect(), sampled })
    }
}
