//! One attempt: a scheme, from a number of coarsest steps on. Points become paths here.

use std::{
    cell::{Cell, RefCell},
    collections::{BTreeMap, btree_map::Entry},
    ops::Range,
    sync::Arc,
};

use noise::{QuasiWiener, ScrambledSobol};
use real::WIDTH;

use super::{
    Candidate,
    error::ExpectError,
    estimator::{Estimator, Halt},
    level::{Drawn, PathValues, Samples, Sums, Values},
    report::Expectation,
    resolution::Motion,
    settings::Settings,
};
use crate::{
    DampingResolution, Ladder, LadderError, NextNoise, NoiseSource, Observe, Run,
    driver::GROUP_PATHS, ladder::Piece, observable::value, parts::Job,
};

/// The most levels of a path without noise: 2²² steps take seconds.
const MOST_HALVINGS: usize = 22;
/// In more dimensions Sobol points gain nothing over random ones, and take memory.
const MOST_DIMENSIONS: u64 = 1 << 16;

/// The increments of the points of all scrambles. A path has the number of its replicate times
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
        wiener.block(first_path % ScrambledSobol::POINTS, &mut increments);
        let (mut next, noises) = (0, self.noises);
        Box::new(move |noise| {
            noise.increments.copy_from_slice(&increments[next..next + noises]);
            next += noises;
        })
    }
}

/// What every attempt is asked for.
pub struct Asked<'a> {
    pub job: &'a Job,
    pub observables: &'a [&'a dyn Observe],
    pub accuracy: f64,
    pub progress: &'a (dyn Fn(u64) + Sync),
    /// Path-steps of all attempts so far, which the limit is for.
    pub spent: Cell<u64>,
}

impl Candidate<'_> {
    /// The runs of a sample: fine, coarse, and a second fine and a second coarse one. For several
    /// noises without areas the second fine path takes the increments of every coarse step in the
    /// other order (Giles and Szpruch 2014): then the variance falls like τ² instead of τ.
    fn runs(&self, coupled: bool) -> Vec<Run<'_>> {
        let (scheme, mirror) = (&self.setup.scheme, self.mirror.as_ref());
        let without_areas = self.setup.problem.noises > 1 && !scheme.reads_areas();
        let twin = mirror.or(without_areas.then_some(scheme)).filter(|_| coupled);
        let at = |level: usize| move |scheme| Run::new(Arc::clone(scheme), level);
        let coarse = usize::from(coupled);
        let mut runs = vec![at(0)(scheme)];
        runs.extend(coupled.then(|| at(1)(scheme)));
        runs.extend(twin.map(|twin| Run::swapped(Arc::clone(twin), 0)));
        runs.extend(mirror.map(at(coarse)));
        runs
    }

    /// The expectations by this scheme, as a piece of work with the name `name`.
    pub fn attempt(
        &self,
        name: &str,
        asked: &Asked<'_>,
        settings: Settings,
    ) -> Result<Option<Expectation>, ExpectError> {
        let &Asked { job, observables, accuracy, progress, ref spent } = asked;
        let problem = &self.setup.problem;
        let noisy = problem.noises > 0;
        let halvings = MOST_HALVINGS.saturating_sub(settings.coarsest_steps.ilog2() as usize);
        let settings = match noisy {
            true => settings,
            false => Settings { max_level: halvings.max(3), replicates: 1, ..settings },
        };
        let sobol = noisy && !settings.random_points && !self.setup.scheme.reads_areas();
        let y0 = &problem.y0[..];
        let starts: Vec<f64> = observables.iter().map(|phi| value(*phi, y0)).collect();
        // The ladder of each level, and the nodes of its replicates so far.
        let drawn = RefCell::new(BTreeMap::new());
        let ladder_of = |level: usize| {
            let (key, steps) = (settings.stream(level), settings.steps(level));
            let (levels, runs) = (usize::from(level > 0), self.runs(level > 0));
            let ladder = Ladder::new(problem, steps, levels, settings.truncation, key, runs)?;
            let few = steps.saturating_mul(problem.noises as u64) <= MOST_DIMENSIONS;
            let nodes = vec![Vec::new(); settings.replicates as usize];
            if !(sobol && few) {
                return Ok((ladder, nodes));
            }
            let wiener = QuasiWiener::new(key, 0, steps, problem.noises, problem.t_end)?;
            let scrambles = (0..settings.replicates).map(|number| wiener.of_scramble(number));
            let points = Points { scrambles: scrambles.collect(), noises: problem.noises };
            Ok::<_, LadderError>((ladder.with_noise(points)?, nodes))
        };
        let draw = |samples: &Samples, points: Range<u64>, round: u64| {
            let mut drawn = drawn.borrow_mut();
            let (ladder, nodes) = match drawn.entry(samples.level) {
                Entry::Occupied(drawn) => drawn.into_mut(),
                Entry::Vacant(place) => place.insert(ladder_of(samples.level)?),
            };
            let (last_time, coupled) = (ladder.coarse_steps(), samples.level > 0);
            let values = vec![Values::default(); observables.len()];
            let sums = Sums { values, motion: Motion::new(y0) };
            let starts = &starts[..];
            let new =
                || PathValues { observables, y0, starts, last_time, coupled, sums: sums.clone() };
            let piece = |replicate: u64| {
                let first = replicate * ScrambledSobol::POINTS;
                let (number, from) = (samples.level, points.start);
                Piece {
                    name: format!("{name}/level {number} replicate {replicate} from {from}"),
                    paths: first + points.end,
                    groups: (first + points.start) / GROUP_PATHS
                        ..(first + points.end).div_ceil(GROUP_PATHS),
                }
            };
            // All replicates are begun: none depends on another.
            let pieces: Vec<_> = (0..settings.replicates).map(piece).collect();
            let more = ladder.nodes_in(job, &pieces, Some(round), &new, progress);
            let Some(more) = more.filter(|_| !job.stop().is_asked()) else { return Ok(None) };
            let joined = |(nodes, more): (&mut Vec<_>, Vec<_>)| {
                let outcome = ladder.join(nodes, more, &new);
                let first_failure = outcome.failures.first().copied();
                Drawn { sums: outcome.statistic.sums, failed: outcome.failed, first_failure }
            };
            Ok(Some(nodes.iter_mut().zip(more).map(joined).collect()))
        };
        // Every second run of a difference with a mirror is coarse, else the second one.
        let coarse = if self.mirror.is_some() { 2 } else { 1 };
        let estimator = Estimator {
            draw: &draw,
            scheme: self.setup.scheme.id(),
            t_end: problem.t_end,
            damping: DampingResolution::new(&self.setup, settings.coarsest_steps),
            names: observables.iter().map(|phi| phi.name().to_owned()).collect(),
            accuracy,
            settings,
            orders: self.orders,
            runs: (self.runs(true).len() as u64 - coarse, coarse),
            noisy,
            sobol,
            ranges: vec![None; observables.len()],
            spent,
            stopped: &|| job.gives_what_is_done(),
            levels: Vec::new(),
            first: 0,
        };
        match estimator.expectation() {
            Ok(expectation) => Ok(Some(expectation)),
            Err(Halt::Elsewhere) => Ok(None),
            Err(Halt::Error(error)) => Err(error),
        }
    }
}
