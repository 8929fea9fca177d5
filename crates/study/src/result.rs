//! The result of a study, and its rows in a file.

use std::{
    collections::BTreeMap,
    io::{self, Write},
};

use serde::{Deserialize, Serialize};
use stats::{Tail, Warning, quantile_ranks};

use super::{
    Grid, Joint, Wanted,
    dependence::{Cells, Found},
    settings::Record,
    summary::{
        Histogram, IntervalNote, Place, Quantile, Ranks, STATISTICS, Summary, SummaryStatistic,
    },
    sums::StudyStatistic,
};
use mc::{Measured, quoted};

/// The result of a study: the law of every observable at every time, with everything that made it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StudyResult {
    /// Record of everything that the result depends on.
    pub record: Record,
    /// Failed paths and clipped increments.
    pub losses: Losses,
    /// Warnings that a reader must know before believing the rest: failed paths, values that are
    /// not finite, means and quantiles that are not known well.
    pub warnings: Vec<Warning>,
    /// Series of each observable, then covariance and correlation of each pair that was wanted.
    pub series: Vec<Series>,
    /// The joint law of each pair.
    pub joint: Vec<Joint>,
    /// Autocorrelation and spectrum of each observable of which they were wanted: `time` is the lag
    /// or the frequency.
    pub lagged: Vec<Series>,
}

/// One observable at all times, or what depends on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Series {
    /// Name of the observable, or of the quantity with the observables in it.
    pub observable: String,
    /// The quantity.
    pub kind: Kind,
    /// The initial value and the times of the study; of lags and frequencies all.
    pub points: Vec<Summary>,
}

/// The quantity of a [`Series`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// An observable in time.
    #[default]
    Observable,
    /// Covariance of two observables in time.
    Covariance,
    /// Correlation of two observables in time.
    Correlation,
    /// Autocorrelation against the lag.
    Autocorrelation,
    /// Spectrum against the angular frequency.
    Spectrum,
}

impl Kind {
    /// Name of the axis: `t`, `lag` or `omega`.
    pub fn axis(self) -> &'static str {
        match self {
            Self::Observable | Self::Covariance | Self::Correlation => "t",
            Self::Autocorrelation => "lag",
            Self::Spectrum => "omega",
        }
    }
}

/// Failed paths and clipped increments.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Losses {
    /// Number of failed paths. Statistics exclude a path from the time on at which it failed.
    pub failed: u64,
    /// The first failed paths, each with what replays it, as in [`Measured::failures`].
    pub failures: Vec<String>,
    /// Number of clipped increments, counted on paths that had not failed.
    pub clipped: u64,
}

impl StudyResult {
    /// The result of sums over all paths of a record, or those that were done when it was stopped.
    pub(super) fn new(
        record: &Record,
        grids: &[Grid],
        wanted: &Wanted,
        measured: &Measured<StudyStatistic<'_>>,
    ) -> Self {
        let sums = &measured.statistic.sums;
        let losses = Losses {
            failed: measured.failed,
            failures: measured.failures.iter().map(ToString::to_string).collect(),
            clipped: measured.clipped.iter().sum(),
        };
        let (names, planned) = (record.observables.iter().zip(&record.initial), record.paths);
        let count = record.observables.len();
        let last = record.times.len().saturating_sub(1) * count;
        let paths = sums.moments[last].count() + sums.not_finite[last] + losses.failed;
        let record = Record { paths, ..record.clone() };
        // They are kept, since most counts are the same.
        let mut known = BTreeMap::<(u64, usize), Vec<Ranks>>::new();
        let tail = |k: usize| sums.moments[last + k].tail(sums.first.get(k).map_or(&[], |of| of));
        let tails: Vec<Tail> = (0..count).map(tail).collect();
        let mut series: Vec<_> = names
            .enumerate()
            .map(|(k, (name, initial))| {
                let is_probability = wanted.probabilities.contains(&k);
                let levels = if is_probability { &[][..] } else { &record.quantiles };
                let exact = Summary::exact(*initial, paths, levels);
                let mut points = Vec::from_iter(record.start.is_none().then_some(exact));
                for (time, &step) in record.times.iter().enumerate() {
                    let cell = time * count + k;
                    let mut histogram = Histogram::empty(grids[cell]);
                    histogram.add(&sums.counts(cell, &grids[cell]));
                    let values = sums.moments[cell].count();
                    let ranks = known.entry((values, levels.len())).or_insert_with(|| {
                        levels.iter().map(|&level| (level, quantile_ranks(values, level))).collect()
                    });
                    let at = (step, record.time(step));
                    let summary = Summary::new(at, sums, cell, histogram, (ranks, tails[k]));
                    points.push(if is_probability { summary.of_probability() } else { summary });
                }
                Series { observable: name.clone(), kind: Kind::Observable, points }
            })
            .collect();
        let mut warnings = warnings(&losses, paths, &series, &tails);
        if paths < planned {
            warnings.push(Warning::new(format!("stopped after {paths} of {planned} paths")));
        }
        let found = Found {
            of: Cells { wanted, grids, observables: count },
            names: &record.observables,
            at: record.times.iter().map(|&step| (step, record.time(step))).collect(),
            sums: &sums.dependence,
        };
        series.extend(found.pairs(record.start.is_none().then_some(paths)));
        let (joint, lagged) = (found.joint(), found.lagged());
        warnings.extend(lagged.iter().filter_map(lasts));
        Self { record, losses, warnings, series, joint, lagged }
    }

    /// The series of the observable with this name, if there is one.
    pub fn series(&self, observable: &str) -> Option<&Series> {
        self.series.iter().find(|series| series.observable == observable)
    }

    /// Writes one row for each time, observable and quantity, as CSV with the columns `t`,
    /// `observable`, `quantity`, `value`, `lo`, `hi` and `note`. `lo` and `hi` are the ends of the
    /// 95 % interval. What is not known is empty. Numbers are written in the shortest form that is
    /// read back to the same bits.
    ///
    /// | quantity | value |
    /// |---|---|
    /// | `count`, `not finite` | number of values, and of those that are not finite and left out |
    /// | `mean` | mean with interval; a note says why there is none |
    /// | `variance`, `deviation` | variance, standard deviation |
    /// | `least`, `largest` | smallest and largest value |
    /// | `q0.05` … | quantile with interval; a note says why there is no value |
    /// | `below grid`, `above grid` | number of values outside of the bins |
    ///
    /// Histograms and the record are among the fields, which serialize.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_csv(&self, out: &mut impl Write) -> io::Result<()> {
        writeln!(out, "{COLUMNS}")?;
        write_rows(&self.series, "", out)
    }
}

impl Series {
    /// Summary at the last time.
    pub fn last(&self) -> &Summary {
        // The initial value is always there.
        &self.points[self.points.len() - 1]
    }
}

/// Warning of an autocorrelation that lasts for most of its lags, where the window of the spectrum
/// falls.
fn lasts(Series { observable, kind, points }: &Series) -> Option<Warning> {
    const SMALL: f64 = 0.05;
    let late = &points[2 * points.len() / 3..];
    let large =
        |point: &&Summary| point.mean_interval.is_some_and(|(lo, hi)| lo > SMALL || hi < -SMALL);
    if *kind != Kind::Autocorrelation || late.iter().filter(large).count() <= late.len() / 10 {
        return None;
    }
    // Without rounding errors.
    let to = format!("{:.9e}", points[points.len() - 1].time).parse().unwrap_or(f64::NAN);
    let what = format!("{observable} is not small up to a lag of {to}");
    let why = "peaks of its spectrum are broader and lower than they should be";
    Some(Warning::new(what).with_reason(why).with_remedy("take a longer time"))
}

/// Condition for a warning to concern a time.
type Concerns<'a> = &'a dyn Fn(&Summary) -> bool;

fn warnings(losses: &Losses, paths: u64, series: &[Series], tails: &[Tail]) -> Vec<Warning> {
    let failed = losses.failed;
    let lost = Warning::new(format!("{failed} of {paths} paths failed"));
    let lost = lost.with_reason("what is left is no fair sample");
    let mut warnings: Vec<Warning> = (failed > 0).then_some(lost).into_iter().collect();
    let at = |point: &Summary, of: &[Place]| point.quantiles.iter().any(|q| of.contains(&q.place));
    for (Series { observable, points, .. }, tail) in series.iter().zip(tails) {
        let [few, heavy] = [IntervalNote::TooFew.to_string(), tail.to_string()];
        let concerns: [(&str, Concerns<'_>); 5] = [
            ("values that are not finite, left out", &|point| point.not_finite > 0),
            (&few, &|point| point.interval_note == Some(IntervalNote::TooFew)),
            (
                "a quantile lies outside of the grid: a larger pilot would choose a wider one",
                &|point| at(point, &[Place::BelowGrid, Place::AboveGrid]),
            ),
            (Place::Crowded.note(), &|point| at(point, &[Place::Crowded])),
            (&heavy, &|point| matches!(point.interval_note, Some(IntervalNote::Heavy(_)))),
        ];
        for (what, concerns) in concerns {
            let mut times = points.iter().filter(|point| concerns(point)).map(|point| point.time);
            if let Some(first) = times.next() {
                let number = 1 + times.count();
                let when = match number {
                    1 => format!("at t = {first:.6}"),
                    _ => format!("at {number} times, first t = {first:.6}"),
                };
                warnings.push(Warning::new(format!("{what} {when}")).about(observable));
            }
        }
    }
    warnings
}

/// The columns of [`write_rows`].
pub const COLUMNS: &str = "t,observable,quantity,value,lo,hi,note";

/// Writes the rows of [`StudyResult::write_csv`], each after the text `before`.
///
/// # Errors
/// Those of the writer.
pub fn write_rows(series: &[Series], before: &str, out: &mut impl Write) -> io::Result<()> {
    let text = |x: Option<f64>| x.map_or(String::new(), |x| format!("{x:?}"));
    let number = |count: u64| [count.to_string(), String::new(), String::new()];
    for Series { observable, points, .. } in series {
        let name = quoted(observable);
        for point @ Summary { time, .. } in points {
            let mut row = |quantity: &str, [value, lo, hi]: [String; 3], note: &str| {
                writeln!(out, "{before}{time:?},{name},{quantity},{value},{lo},{hi},{note}")
            };
            row("count", number(point.count), "")?;
            row("not finite", number(point.not_finite), "")?;
            for SummaryStatistic { key, of, interval, .. } in STATISTICS {
                let (lo, hi) = interval.map(|ends| ends(point).unzip()).unwrap_or_default();
                let note = point.interval_note.as_ref().filter(|_| interval.is_some());
                let note = note.map_or(String::new(), ToString::to_string);
                row(key, [of(point), lo, hi].map(text), &note)?;
            }
            for &Quantile { level, value, lo, hi, place } in &point.quantiles {
                row(&format!("q{level}"), [value, lo, hi].map(text), place.note())?;
            }
            if let Some(histogram) = &point.histogram {
                row("below grid", number(histogram.below), "")?;
                row("above grid", number(histogram.above), "")?;
            }
        }
    }
    Ok(())
}
