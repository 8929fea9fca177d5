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

use std::{
    cell::{Cell, RefCell},
    collections::{BTreeMap, btree_map::Entry},
    ops::Range,
    sync::Arc,
};

use noise::{QuasiWiener, ScrambledSobol};
use real::WIDTH;
use schemes::Method;

use super::{
    Drawn, Expectation, ExpectationSettings, MultilevelError, PathValues, Samples, Sums, Values,
    algorithm::Halt, resolution::Motion, settings::Coupling,
};
use crate::{
    Ladder, NextNoise, NoiseSource, Observe, Run, SeenDamping, Setup, driver::GROUP_PATHS,
    ladder::Piece, observable::value, parts::Job,
};
use algorithm::Quasi;
pub(crate) use extrapolation::Orders;

/// The increments of the points of all scrambles. A path has the number of its scramble times
/// [`ScrambledSobol::POINTS`], plus that of its point.
struct Points {
    scrambles: Vec<QuasiWiener>,
    noises: usize,
}

impl NoiseSource for Points {
    fn block(&self, first_path: u64) -> NextNoise<'_> {
        let scramble = (first_path / ScrambledSobol::POINTS) as usize;
        let wiener = &self.scrambles[scramble];
        let mut increments = vec![[0.0; WIDTH]; wiener.dimensions()];
        let drawn = wiener.block(first_path % ScrambledSobol::POINTS, &mut increments);
        drawn.unwrap_or_else(|error| unreachable!("the points of a block are many: {error}"));
        let (mut next, noises) = (0, self.noises);
        Box::new(move |noise| {
            noise.increments.copy_from_slice(&increments[next..next + noises]);
            next += noises;
        })
    }
}

/// What is computed beside one scheme at random points.
pub(crate) struct QuasiSettings<'a> {
    /// The scheme with the noises in the other order: φ is averaged over both.
    pub mirror: Option<&'a Arc<dyn Method + 'a>>,
    /// How the bias falls.
    pub orders: Orders,
    /// Independent scrambles.
    pub scrambles: u64,
    /// Path-steps of all attempts so far, which the limit is for.
    pub spent: &'a Cell<u64>,
}

/// The most levels of a path without noise: 2²² steps take seconds.
const MOST_HALVINGS: usize = 22;

/// E[φ(y(T))] of every φ by scrambled Sobol points, as a piece of work of a job; see
/// [`expectation_in`](super::expectation_in).
#[expect(clippy::too_many_arguments, reason = "those of `expectation_in`, and one more")]
pub(crate) fn quasi_expectation(
    job: &Job,
    name: &str,
    setup: &Setup<'_>,
    &QuasiSettings { mirror, orders, scrambles, spent }: &QuasiSettings<'_>,
    observables: &[&dyn Observe],
    accuracy: f64,
    settings: &ExpectationSettings,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Option<Expectation>, MultilevelError> {
    let Setup { problem, scheme } = setup;
    let random = problem.noises > 0;
    let most = MOST_HALVINGS.saturating_sub(settings.coarsest_steps.max(1).ilog2() as usize).max(3);
    let max_level = if random { settings.max_level } else { most };
    let settings = &ExpectationSettings { max_level, ..*settings };
    let scrambles = if random { scrambles } else { 1 };
    let y0 = &problem.y0[..];
    let starts: Vec<f64> = observables.iter().map(|phi| value(*phi, y0)).collect();
    // The ladder of each level, and the nodes of its scrambles so far.
    let drawn = RefCell::new(BTreeMap::new());
    let (coupling, runs) = match (mirror, settings.coupling) {
        (Some(_), _) => (Coupling::Antithetic, (2, 2)),
        (None, Coupling::Antithetic) => (Coupling::Antithetic, (2, 1)),
        (None, Coupling::Plain) => (Coupling::Plain, (1, 1)),
    };
    let ladder_of = |level: &Samples| {
        let coupled = level.coupling.is_some();
        let mut runs = vec![Run::new(Arc::clone(scheme), 0)];
        if coupled {
            runs.push(Run::new(Arc::clone(scheme), 1));
        }
        match (mirror, coupling) {
            (Some(mirror), _) if coupled => {
                runs.push(Run::swapped(Arc::clone(mirror), 0));
                runs.push(Run::new(Arc::clone(mirror), 1));
            }
            (Some(mirror), _) => runs.push(Run::new(Arc::clone(mirror), 0)),
            (None, Coupling::Antithetic) if coupled => {
                runs.push(Run::swapped(Arc::clone(scheme), 0));
            }
            (None, _) => (),
        }
        let (key, steps) = (settings.stream(level.level), settings.steps(level.level));
        let levels = usize::from(coupled);
        let ladder = Ladder::new(problem, steps, levels, settings.truncation, key, runs)?;
        let wiener = QuasiWiener::new(key, 0, steps, problem.noises, problem.t_end)
            .map_err(crate::LadderError::from)?;
        let points = Points {
            scrambles: (0..scrambles).map(|scramble| wiener.of_scramble(scramble)).collect(),
            noises: problem.noises,
        };
        let nodes = vec![Vec::new(); scrambles as usize];
        Ok::<_, MultilevelError>((ladder.with_noise(points)?, nodes))
    };
    let draw = |level: &Samples, points: Range<u64>, round: u64| {
        let mut drawn = drawn.borrow_mut();
        let (ladder, nodes) = match drawn.entry(level.level) {
            Entry::Occupied(drawn) => drawn.into_mut(),
            Entry::Vacant(place) => place.insert(ladder_of(level)?),
        };
        let (last_time, coupled) = (ladder.coarse_steps(), level.coupling.is_some());
        let values = vec![Values::default(); observables.len()];
        let motion = Motion::new(y0);
        let new = || {
            let sums = Sums { values: values.clone(), motion: motion.clone() };
            PathValues { observables, y0, starts: &starts, last_time, coupled, sums }
        };
        let piece = |scramble: u64| {
            let first = scramble * ScrambledSobol::POINTS;
            let (number, from) = (level.level, points.start);
            Piece {
                name: format!("{name}/level {number} scramble {scramble} from {from}"),
                paths: first + points.end,
                groups: (first + points.start) / GROUP_PATHS
                    ..(first + points.end).div_ceil(GROUP_PATHS),
            }
        };
        // All scrambles are begun: none depends on another.
        let pieces: Vec<_> = (0..scrambles).map(piece).collect();
        let more = ladder.nodes_in(job, &pieces, Some(round), &new, progress);
        let Some(more) = more.filter(|_| !job.stop().is_asked()) else { return Ok(None) };
        let joined = |(nodes, more): (&mut Vec<_>, Vec<_>)| {
            let outcome = ladder.join(nodes, more, &new);
            let first_failure = outcome.failures.first().copied();
            Drawn { sums: outcome.statistic.sums, failed: outcome.failed, first_failure }
        };
        Ok(Some(nodes.iter_mut().zip(more).map(joined).collect()))
    };
    let names = observables.iter().map(|observable| observable.name().to_owned()).collect();
    let quasi = Quasi {
        draw: &draw,
        scheme: scheme.id(),
        t_end: problem.t_end,
        damping: SeenDamping::new(setup, settings.coarsest_steps),
        names,
        accuracy,
        settings,
        scrambles,
        orders,
        coupling,
        runs,
        single: if mirror.is_some() { 2 } else { 1 },
        ranges: vec![None; observables.len()],
        spent,
        random,
        stopped: &|| job.gives_what_is_done(),
        decisions: Vec::new(),
    };
    match quasi.expectation() {
        Ok(expectation) => Ok(Some(expectation)),
        Err(Halt::Elsewhere) => Ok(None),
        Err(Halt::Error(error)) => Err(error),
    }
}
