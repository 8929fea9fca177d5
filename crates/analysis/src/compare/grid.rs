//! Schemes at step sizes on the same noise, with a reference.

use std::{array, ops::Range, sync::Arc};

use mc::{Ladder, LadderError, Problem, Run, parts::Stop};
use noise::{StreamKey, Truncation};
use schemes::Method;
use serde::{Deserialize, Serialize};
use stats::CrossMoments;

use super::{own_areas::as_drawn, time::Time};
use crate::{FinalMoments, FinalRows};

/// Which schemes run at which step sizes, on which noise, and against what.
pub struct Grid<'a> {
    /// The problem.
    pub problem: &'a Problem<'a>,
    /// The schemes on its system.
    pub schemes: Vec<Arc<dyn Method + 'a>>,
    /// The levels of each scheme; level l has `finest_steps`/2^l steps.
    pub levels: Vec<Range<usize>>,
    /// The reference. It should have strong order one.
    pub reference: Arc<dyn Method + 'a>,
    /// Its level. It runs on the next two levels as well, to estimate its own error.
    pub reference_level: usize,
    /// Number of the finest steps.
    pub finest_steps: u64,
    /// Paths.
    pub samples: u64,
    /// How increments are truncated.
    pub truncation: Truncation,
    /// Which noise.
    pub key: StreamKey,
    /// Ends the runs; what was measured is then of no use.
    pub stop: Stop,
}

/// What the errors of a grid are made of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sampled {
    /// Paths behind every error.
    pub samples: u64,
    /// Paths that were left out because some scheme at some step size had no solution or was not
    /// finite.
    pub failed: u64,
    /// The first few of them.
    pub failures: Vec<String>,
    /// What errors are measured against.
    pub reference: String,
}

/// The errors of one scheme.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Series<P> {
    /// Its identifier.
    pub scheme: String,
    /// A point for each step size, coarsest first.
    pub points: Vec<P>,
}

/// A point at a step size, whose time may be measured.
pub trait Timed {
    /// Steps of a path.
    fn steps(&self) -> u64;
    /// Sets the processor time of a path.
    fn set_time(&mut self, time: Time);
}

impl<P: Timed> Series<P> {
    /// Adds the times of some numbers of steps.
    pub fn add_times(&mut self, times: &[(u64, Time)]) {
        for point in &mut self.points {
            if let Some((_, time)) = times.iter().find(|(steps, _)| *steps == point.steps()) {
                point.set_time(*time);
            }
        }
    }
}

/// Runs of the reference: at its level and at the next two.
pub(super) const REFERENCES: usize = 3;

impl<'a> Grid<'a> {
    /// Path-steps of all runs.
    pub fn work(&self) -> u64 {
        let points = self.levels.iter().cloned().flatten();
        let references = self.reference_level..self.reference_level + REFERENCES;
        let steps = |level| self.finest_steps >> level;
        points.chain(references).map(|level| steps(level) * self.samples).sum()
    }

    /// Number of points of all schemes, one at each step size.
    pub(super) fn points(&self) -> usize {
        self.levels.iter().map(|levels| levels.len()).sum()
    }

    /// Whether a scheme reads areas, so that it has another error with exact ones.
    fn reads(&self, s: usize) -> bool {
        self.schemes[s].reads_areas()
    }

    /// The number among all points of that of scheme `s` with this many steps.
    pub(super) fn point_number(&self, s: usize, steps: u64) -> Option<usize> {
        let before: usize = self.levels.get(..s)?.iter().map(|levels| levels.len()).sum();
        let mut levels = self.levels.get(s)?.clone().rev();
        levels.position(|level| self.steps(level) == steps).map(|n| before + n)
    }

    /// The number of steps at a level.
    pub(super) fn steps(&self, level: usize) -> u64 {
        self.finest_steps >> level
    }

    /// The states of the reference, in words.
    pub(super) fn reference_steps(&self) -> [u64; REFERENCES] {
        array::from_fn(|k| self.steps(self.reference_level + k))
    }

    /// Moments of `length` values of the final states: those of the reference on its three levels,
    /// then those of every scheme at every step size, coarsest first, and then the same again with
    /// exact areas for the schemes that read areas, where `exact` is asked for.
    ///
    /// # Errors
    /// [`LadderError`] when there is no step, or when truncation is not defined at a step size.
    pub(super) fn moments(
        &self,
        exact: bool,
        length: usize,
        values: &FinalRows<'_>,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<(CrossMoments, Sampled), LadderError> {
        let on = |scheme: &Arc<dyn Method + 'a>, levels: Range<usize>| {
            let runs = levels.map(|level| Run::new(Arc::clone(scheme), level));
            runs.collect::<Vec<_>>()
        };
        let first = self.reference_level;
        let mut runs = on(&self.reference, first..first + REFERENCES);
        for (scheme, levels) in self.schemes.iter().zip(&self.levels) {
            runs.extend(on(&as_drawn(scheme), levels.clone()).into_iter().rev());
        }
        for s in (0..self.schemes.len()).filter(|&s| exact && self.reads(s)) {
            runs.extend(on(&self.schemes[s], self.levels[s].clone()).into_iter().rev());
        }
        let top = runs.iter().map(|run| run.level).max().unwrap_or(0);
        let Self { problem, finest_steps, samples, truncation, key, .. } = *self;
        let ladder = Ladder::new(problem, finest_steps, top, truncation, key, runs)?;
        let new = || FinalMoments::of_rows(ladder.coarse_steps(), length, values);
        let measured = ladder.run_until(&self.stop, 0, samples, new, progress);
        let sampled = Sampled {
            samples,
            failed: measured.failed,
            failures: measured.failures.iter().map(ToString::to_string).collect(),
            reference: self.reference.id().to_owned(),
        };
        Ok((measured.statistic.moments, sampled))
    }

    /// A series for each scheme, from the scheme, the number of the point among all, its number
    /// among those with exact areas, and the number of steps.
    pub(super) fn series<P>(
        &self,
        point: impl Fn(usize, Option<usize>, u64) -> P,
    ) -> Vec<Series<P>> {
        let (mut number, mut exact) = (0, self.points());
        let mut all = Vec::with_capacity(self.schemes.len());
        for (s, scheme) in self.schemes.iter().enumerate() {
            let mut points = Vec::new();
            for level in self.levels[s].clone().rev() {
                let with_exact = self.reads(s).then_some(exact);
                points.push(point(number, with_exact, self.steps(level)));
                number += 1;
                exact += usize::from(self.reads(s));
            }
            all.push(Series { scheme: scheme.id().to_owned(), points });
        }
        all
    }

    /// Number of points with exact areas.
    pub(super) fn exact_points(&self) -> usize {
        let readers = (0..self.schemes.len()).filter(|&s| self.reads(s));
        readers.map(|s| self.levels[s].len()).sum()
    }
}
