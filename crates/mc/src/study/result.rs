//! The result of a study.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use stats::quantile_ranks;

use super::{
    Grid,
    record::Record,
    summary::{CROWDED, Histogram, Place, Ranks, Summary, TOO_FEW},
    sums::StudyStatistic,
};
use crate::Measured;

/// What is known of the law of every observable at every time, with everything that made it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StudyResult {
    /// What was computed.
    pub record: Record,
    /// Paths that failed.
    pub losses: Losses,
    /// What a reader must know before believing the rest: failed paths, values that are not finite,
    /// means and quantiles that are not known well.
    pub warnings: Vec<String>,
    /// One for each observable.
    pub series: Vec<Series>,
}

/// One observable at all times.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Series {
    /// Its name.
    pub observable: String,
    /// The initial value and the times of the study.
    pub points: Vec<Summary>,
}

/// Failed paths and clipped increments.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Losses {
    /// Number of failed paths. Statistics exclude a path from the time on at which it failed.
    pub failed: u64,
    /// The first of them, each with what replays it, as in [`Measured::failures`].
    pub failures: Vec<String>,
    /// Number of clipped increments, counted on paths that had not failed.
    pub clipped: u64,
}

impl StudyResult {
    /// The result of sums over all paths of a record, or those that were done when it was stopped.
    pub(super) fn new(
        record: &Record,
        grids: &[Grid],
        measured: &Measured<StudyStatistic<'_>>,
    ) -> Self {
        let sums = &measured.statistic.sums;
        let losses = Losses {
            failed: measured.failed,
            failures: measured.failures.iter().map(ToString::to_string).collect(),
            clipped: measured.clipped.iter().sum(),
        };
        let last = record.times.len().saturating_sub(1) * record.observables.len();
        let done = sums.moments(last).count() + sums.not_finite(last) + losses.failed;
        let planned = record.paths;
        let record = &Record { paths: done, ..record.clone() };
        let levels = &record.quantiles;
        let ranks = |count| levels.iter().map(move |&level| (level, quantile_ranks(count, level)));
        // They are kept, since most counts are the same.
        let mut known = BTreeMap::<u64, Vec<Ranks>>::new();
        let observables = record.observables.iter().zip(&record.initial).enumerate();
        let series = observables.map(|(k, (name, initial))| {
            let later = record.times.iter().enumerate().map(|(time, &step)| {
                let cell = time * record.observables.len() + k;
                let histogram = Histogram::new(grids[cell], sums.counts(cell, &grids[cell]));
                let at = (step, record.time(step));
                let count = sums.moments(cell).count();
                let ranks = known.entry(count).or_insert_with(|| ranks(count).collect());
                Summary::new(at, sums, cell, histogram, ranks)
            });
            let first = Summary::exact(*initial, record.paths, &record.quantiles);
            Series { observable: name.clone(), points: [first].into_iter().chain(later).collect() }
        });
        let series: Vec<_> = series.collect();
        let mut warnings = warnings(record, &losses, &series);
        if done < planned {
            warnings.push(format!("stopped after {done} of {planned} paths"));
        }
        Self { record: record.clone(), losses, warnings, series }
    }

    /// The series of the observable with this name, if there is one.
    pub fn series(&self, observable: &str) -> Option<&Series> {
        self.series.iter().find(|series| series.observable == observable)
    }
}

impl Series {
    /// The last time.
    pub fn last(&self) -> &Summary {
        // The initial value is always there.
        &self.points[self.points.len() - 1]
    }
}

fn warnings(record: &Record, losses: &Losses, series: &[Series]) -> Vec<String> {
    let mut warnings = Vec::new();
    if losses.failed > 0 {
        warnings.push(format!(
            "{} of {} paths failed: what is left is no fair sample",
            losses.failed, record.paths
        ));
    }
    for Series { observable, points } in series {
        let mut warn = |what: &str, concerns: &dyn Fn(&Summary) -> bool| {
            let times = points.iter().filter(|point| concerns(point));
            let (mut times, number) = (times.clone().map(|point| point.time), times.count());
            if let Some(first) = times.next() {
                warnings
                    .push(format!("{observable}: {what} at {number} times, first t = {first:.6}"));
            }
        };
        warn("values that are not finite, left out", &|point| point.not_finite > 0);
        warn(TOO_FEW, &|point| point.interval_note.as_deref() == Some(TOO_FEW));
        warn(
            "a quantile lies outside of the grid: a larger pilot would choose a wider one",
            &|p| {
                let outside = |place| matches!(place, Place::BelowGrid | Place::AboveGrid);
                p.quantiles.iter().any(|quantile| outside(quantile.place))
            },
        );
        warn(CROWDED, &|point| point.quantiles.iter().any(|q| q.place == Place::Crowded));
    }
    warnings
}
