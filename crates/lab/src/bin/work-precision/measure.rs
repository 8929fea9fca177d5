//! Errors and times of every scheme on every problem.

use std::collections::BTreeMap;

use anyhow::Result;
use lab::{
    OtherNoise, TRUNCATED, set_up,
    setups::{Kind, Setup, Visit, visit_paper},
    truncation,
};
use mc::{Run, View, squared_distance};
use noise::{BlockNoise, Noise};
use schemes::{Scheme, Step};
use stats::CrossMoments;
use systems::{Damping, Invariant, PoissonSystem};
use verify::{
    FinalMoments, FinalValues, Progress, Settings, StepSizes,
    work_precision::{Time, WorkPoint, ladder, path_times},
};

use crate::{
    own_areas::{disturb, terms},
    results::{
        Case, Cost, Sampled, Series, Strong, StrongPoint, Weak, WeakObservable, WeakPoint, costs,
    },
    sizes::Sizes,
};

/// Measures the cases named by `only`, or all where it is empty: errors on the current rayon pool,
/// times on one thread.
///
/// Everything but the times is the same bits for the same seed and mode.
pub fn measure(settings: Settings, only: &[String], progress: &dyn Progress) -> Result<Vec<Case>> {
    let mut cases = Cases { settings, only, progress, number: 0, measured: Vec::new() };
    visit_paper(&mut cases)?;
    Ok(cases.measured)
}

struct Cases<'a> {
    settings: Settings,
    only: &'a [String],
    progress: &'a dyn Progress,
    number: u64,
    measured: Vec<Case>,
}

impl Visit for Cases<'_> {
    fn visit<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
        &mut self,
        setup: Setup<S, G, D, M>,
    ) -> Result<()> {
        self.number += 1;
        if !self.only.is_empty() && self.only.iter().all(|id| id != setup.id) {
            return Ok(());
        }
        let timed: Vec<&dyn Scheme<S, D, M>> =
            setup.schemes.iter().map(|(_, scheme)| scheme.as_ref()).collect();
        let levy = timed.iter().copied().find(|scheme| scheme.reads_areas());
        let noise = |step: &Step, noise: &BlockNoise<M>, p: usize| {
            let right = noise.path(p);
            Noise { areas: disturb(step.tau, right.areas), ..right }
        };
        let own = levy.map(|scheme| OtherNoise { scheme, noise });
        let measured = timed.iter().map(|&scheme| match &own {
            Some(own) if scheme.reads_areas() => own,
            _ => scheme,
        });
        let case = Measurement {
            progress: self.progress,
            sizes: Sizes::new(self.settings, self.number, levy.is_some()),
            levy,
            measured: measured.collect(),
            timed,
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
    /// The same as their errors are measured: see [`disturb`].
    measured: Vec<&'a dyn Scheme<S, D, M>>,
    /// The scheme with exact Lévy areas, where it differs from the one without.
    levy: Option<&'a dyn Scheme<S, D, M>>,
}

/// The times of every scheme by its number, each by the number of steps.
type Times = Vec<BTreeMap<u64, Time>>;

impl<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>
    Measurement<'_, S, G, D, M>
{
    fn run(&self) -> Result<Case> {
        let Setup { id, title, system, problem, .. } = self.setup;
        let times = self.times()?;
        Ok(Case {
            id,
            title,
            setup: set_up(system, problem, TRUNCATED),
            invariants: problem.system().invariants().iter().map(|f| f.name).collect(),
            strong: self.strong(&times)?,
            weak: self.weak(&times)?,
        })
    }

    fn times(&self) -> Result<Times> {
        let Self { timed, progress, .. } = self;
        let Sizes { repetitions, timed: key, .. } = self.sizes;
        let steps = self.sizes.timed_steps();
        progress.begin(&format!("{}: times", self.setup.id), repetitions.work(timed.len(), &steps));
        let problem = &self.setup.problem;
        let times = path_times(timed, problem, &steps, truncation(), key, repetitions, &|work| {
            progress.advance(work);
        })?;
        progress.end();
        let by_steps = |times| steps.iter().copied().zip(times).collect();
        Ok(times.into_iter().map(by_steps).collect())
    }

    /// Moments of `length` values of the final states: those of the reference, then those of every
    /// scheme at every step size. Of two references the first is extrapolated.
    fn errors(
        &self,
        sizes: &StepSizes,
        schemes: &[&dyn Scheme<S, D, M>],
        references: usize,
        length: usize,
        values: &FinalValues<'_, D>,
    ) -> Result<(CrossMoments, Sampled)> {
        let finest = sizes.reference_steps();
        let reference = match references {
            1 => format!("with {finest} steps"),
            _ => format!("extrapolated from {} and {finest} steps", finest / 2),
        };
        let scheme = self.levy.unwrap_or(self.timed[0]);
        let references = (0..references).map(|level| Run::new(scheme, level)).collect();
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
            reference: format!("{} {reference} on the same noise", scheme.id()),
        };
        Ok((measured.statistic.moments, sampled))
    }

    /// A series for each scheme, of the points of its number, of a step size and its number of
    /// steps.
    fn series<P>(
        &self,
        sizes: &StepSizes,
        point: impl Fn(usize, usize, u64) -> P,
        costs: impl Fn(&[P]) -> Option<Vec<Cost>>,
    ) -> Vec<Series<P>> {
        let series = |(s, (kind, scheme)): (usize, &(Kind, Box<dyn Scheme<S, D, M>>))| {
            let points: Vec<P> =
                sizes.steps().enumerate().map(|(l, steps)| point(s, l, steps)).collect();
            Series { kind: *kind, scheme: scheme.id(), costs: costs(&points), points }
        };
        self.setup.schemes.iter().enumerate().map(series).collect()
    }

    /// The values are squared errors of every run, then squared defects of every run and invariant.
    /// Behind the schemes stands the one with exact Lévy areas.
    fn strong(&self, times: &Times) -> Result<Strong> {
        let problem = &self.setup.problem;
        let (system, t_end) = (problem.system(), problem.t_end());
        let law = |(index, invariant): (usize, Invariant)| {
            let decay = (-invariant.degree * problem.damping().integral(0.0, t_end)).exp();
            decay * system.invariant(index, problem.y0())
        };
        let laws: Vec<f64> = system.invariants().into_iter().enumerate().map(law).collect();
        let mut schemes = self.measured.clone();
        schemes.extend(self.levy);
        let sizes = &self.sizes.strong;
        let runs = schemes.len() * sizes.levels;
        let values = |view: &View<'_, D>, p: usize, values: &mut [f64]| {
            let (squares, defects) = values.split_at_mut(runs);
            for run in 0..runs {
                let y = view.states[1 + run].path(p);
                squares[run] = squared_distance(y, view.states[0].path(p));
                for (index, law) in laws.iter().enumerate() {
                    let defect = system.invariant(index, y) / law - 1.0;
                    defects[run * laws.len() + index] = defect * defect;
                }
            }
        };
        let length = runs * (1 + laws.len());
        let (moments, sampled) = self.errors(sizes, &schemes, 1, length, &values)?;
        let rms = |index: usize| moments.mean(index).sqrt();
        let point = |s: usize, l: usize, steps: u64| {
            let run = s * sizes.levels + l;
            let work = WorkPoint::new(t_end, steps, &moments, run, times[s][&steps]);
            let exact = self.timed[s].reads_areas().then_some(self.timed.len() * sizes.levels + l);
            StrongPoint {
                error_exact_areas: exact.map(rms),
                area_terms: exact.map(|_| terms(work.tau, M)),
                defects: (0..laws.len()).map(|i| rms(runs + run * laws.len() + i)).collect(),
                work,
            }
        };
        Ok(Strong { series: self.series(sizes, point, |_| None), sampled })
    }

    /// The values are, for each test function, that of the reference, and for every run its own and
    /// its difference to the reference.
    fn weak(&self, times: &Times) -> Result<Weak> {
        let (sizes, observables) = (&self.sizes.weak, &self.setup.observables);
        let each = 1 + 2 * self.measured.len() * sizes.levels;
        let values = |view: &View<'_, D>, p: usize, values: &mut [f64]| {
            for (observable, values) in observables.iter().zip(values.chunks_exact_mut(each)) {
                let phi = |run: usize| (observable.function)(view.states[run].path(p));
                // An error Cτ + O(τ²) of the expectation is C·2τ + O(τ²) at twice the step.
                values[0] = 2.0 * phi(0) - phi(1);
                for run in 0..each / 2 {
                    values[1 + 2 * run] = phi(2 + run);
                    values[2 + 2 * run] = values[1 + 2 * run] - values[0];
                }
            }
        };
        let length = observables.len() * each;
        let (moments, sampled) = self.errors(sizes, &self.measured, 2, length, &values)?;
        let problem = &self.setup.problem;
        let exact = self.setup.expectations.map(|exact| exact(problem, observables));
        let se = |index: usize| moments.covariance_of_means(index, index).max(0.0).sqrt();
        let observables = observables.iter().enumerate().map(|(f, observable)| {
            let first = f * each;
            let point = |s: usize, l: usize, steps: u64| {
                let value = first + 1 + 2 * (s * sizes.levels + l);
                WeakPoint {
                    steps,
                    tau: problem.t_end() / steps as f64,
                    bias: moments.mean(value + 1),
                    se: se(value + 1),
                    standard_deviation: se(value) * (moments.count() as f64).sqrt(),
                    time: times[s][&steps],
                }
            };
            WeakObservable {
                name: observable.name,
                exact: exact.as_ref().map(|exact| exact[f]),
                reference_mean: moments.mean(first),
                reference_se: se(first),
                series: self.series(sizes, point, |points| Some(costs(points))),
            }
        });
        Ok(Weak { observables: observables.collect(), sampled })
    }
}
