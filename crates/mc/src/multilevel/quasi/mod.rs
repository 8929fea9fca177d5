//! E[φ(y(T))] by scrambled Sobol points.
//!
//! A path of few steps is an integral over few normals, and scrambled Sobol points integrate a
//! smooth function of them with an error far below that of random points. Each level has its own
//! independent scrambles (Owen 1995), the same number of points in each, and the mean over
//! scrambles has an interval by Student's quantile (L'Ecuyer, Nakayama, Owen and Tuffin 2023).
//! Levels are summed as for random points (Giles and Waterhouse 2009), and the sum is extrapolated
//! to τ → 0.

mod algorithm;
mod extrapolation;
mod level;

use std::{cell::RefCell, collections::BTreeMap, ops::Range, sync::Arc};

use noise::{QuasiWiener, StepNoise};
use real::WIDTH;
use schemes::DynScheme;

use super::{
    Drawn, Expectation, ExpectationSettings, MultilevelError, PathValues, Samples, Sums, Values,
    algorithm::Halt, resolution::Motion, settings::Coupling,
};
use crate::{
    DynRun, Ladder, NextNoise, NoiseSource, Observe, SeenDamping, Setup, driver::GROUP_PATHS,
    observable::value, parts::Job,
};
use algorithm::Quasi;
pub(crate) use extrapolation::Orders;

/// The increments of the points of a scramble.
struct Points {
    wiener: QuasiWiener,
    noises: usize,
}

impl<N: StepNoise> NoiseSource<N> for Points {
    fn block(&self, first_path: u64) -> NextNoise<'_, N> {
        let mut increments = vec![[0.0; WIDTH]; self.wiener.dimensions()];
        // The number of points is limited before they are drawn.
        let drawn = self.wiener.block(first_path, &mut increments);
        drawn.unwrap_or_else(|error| unreachable!("{error}"));
        let (mut next, noises) = (0, self.noises);
        Box::new(move |noise: &mut N| {
            noise.increments_mut().copy_from_slice(&increments[next..next + noises]);
            next += noises;
        })
    }
}

/// What is computed beside one scheme at random points.
pub(crate) struct QuasiSettings<'a, N> {
    /// The scheme with the noises in the other order: φ is averaged over both.
    pub mirror: Option<&'a Arc<dyn DynScheme<N> + 'a>>,
    /// How the bias falls.
    pub orders: Orders,
    /// Independent scrambles.
    pub scrambles: u64,
}

/// E[φ(y(T))] of every φ by scrambled Sobol points, as a piece of work of a job; see
/// [`expectation_of_in`](super::expectation_of_in).
#[expect(clippy::too_many_arguments, reason = "those of `expectation_of_in`, and one more")]
pub(crate) fn quasi_expectation<N: StepNoise>(
    job: &Job,
    name: &str,
    setup: &Setup<'_, N>,
    &QuasiSettings { mirror, orders, scrambles }: &QuasiSettings<'_, N>,
    observables: &[&dyn Observe],
    accuracy: f64,
    settings: &ExpectationSettings,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Option<Expectation>, MultilevelError> {
    let Setup { problem, scheme } = setup;
    let y0 = &problem.y0[..];
    let starts: Vec<f64> = observables.iter().map(|phi| value(*phi, y0)).collect();
    // The nodes of each level and scramble so far.
    let drawn = RefCell::new(BTreeMap::new());
    let (coupling, runs) = match (mirror, settings.coupling) {
        (Some(_), _) => (Coupling::Antithetic, (2, 2)),
        (None, Coupling::Antithetic) => (Coupling::Antithetic, (2, 1)),
        (None, Coupling::Plain) => (Coupling::Plain, (1, 1)),
    };
    let draw_one = |level: &Samples, scramble: u64, points: &Range<u64>, round: u64| {
        let number = level.level;
        let coupled = level.coupling.is_some();
        let mut runs = vec![DynRun::new(Arc::clone(scheme), 0)];
        if coupled {
            runs.push(DynRun::new(Arc::clone(scheme), 1));
        }
        match (mirror, coupling) {
            (Some(mirror), _) if coupled => {
                runs.push(DynRun::swapped(Arc::clone(mirror), 0));
                runs.push(DynRun::new(Arc::clone(mirror), 1));
            }
            (Some(mirror), _) => runs.push(DynRun::new(Arc::clone(mirror), 0)),
            (None, Coupling::Antithetic) if coupled => {
                runs.push(DynRun::swapped(Arc::clone(scheme), 0));
            }
            (None, _) => (),
        }
        let (key, steps) = (settings.stream(number), settings.steps(number));
        let levels = usize::from(coupled);
        let ladder = Ladder::of(problem, steps, levels, settings.truncation, key, runs)?;
        let wiener = QuasiWiener::new(key, scramble, steps, problem.noises, problem.t_end)
            .map_err(crate::LadderError::from)?;
        let ladder = ladder.with_noise(Points { wiener, noises: problem.noises })?;
        let last_time = ladder.coarse_steps();
        let values = vec![Values::default(); observables.len()];
        let motion = Motion::new(y0);
        let new = || {
            let sums = Sums { values: values.clone(), motion: motion.clone() };
            PathValues { observables, y0, starts: &starts, last_time, coupled, sums }
        };
        let work = format!("{name}/level {number} scramble {scramble} from {}", points.start);
        let groups = points.start / GROUP_PATHS..points.end / GROUP_PATHS;
        let more = ladder.nodes_in(job, (&work, Some(round)), points.end, groups, &new, progress);
        let Some(more) = more else { return Ok(None) };
        let mut drawn = drawn.borrow_mut();
        let nodes: &mut Vec<_> = drawn.entry((number, scramble)).or_default();
        let outcome = ladder.join(nodes, more, &new);
        let first_failure = outcome.failures.first().copied();
        Ok(Some(Drawn { sums: outcome.statistic.sums, failed: outcome.failed, first_failure }))
    };
    // All scrambles are begun: none depends on another.
    let draw = |level: &Samples, points: Range<u64>, round: u64| {
        let all: Result<Vec<_>, MultilevelError> =
            (0..scrambles).map(|scramble| draw_one(level, scramble, &points, round)).collect();
        Ok(all?.into_iter().collect::<Option<Vec<_>>>())
    };
    let names = observables.iter().map(|observable| observable.name().to_owned()).collect();
    let quasi = Quasi {
        draw: &draw,
        scheme: scheme.id(),
        t_end: problem.t_end,
        damping: SeenDamping::of(setup, settings.coarsest_steps),
        names,
        accuracy,
        settings,
        scrambles,
        orders,
        coupling,
        runs,
        single: if mirror.is_some() { 2 } else { 1 },
        ranges: vec![None; observables.len()],
        cost: 0,
        decisions: Vec::new(),
    };
    match quasi.expectation() {
        Ok(expectation) => Ok(Some(expectation)),
        Err(Halt::Elsewhere) => Ok(None),
        Err(Halt::Error(error)) => Err(error),
    }
}
