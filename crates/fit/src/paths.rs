//! Moments of paths and their derivatives: a problem and nearby ones on the same noise.

use expectation::{Near, SideBySide};
use mc::{Observe, RunError, Setup, View, parts::Stop};
use noise::{Purpose, StreamKey, Truncation};
use rayon::prelude::*;
use real::{Row, elementary};
use serde::{Deserialize, Serialize};
use stats::CrossMoments;

use crate::{Data, Moment, Statistic};

/// Number of independent replicates of the moments.
const REPLICATES: u64 = 32;
/// Largest number of equal intervals of time at whose ends all data are.
const INTERVALS: u64 = 4096;
/// Part of an interval that a time may be off.
const OFF: f64 = 1e-6;

/// Moments of a model over independent paths, in the order of the data.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Replicate {
    /// The moments.
    pub values: Vec<f64>,
    /// The moments by half as many steps on the same noise; the same for a model without steps.
    pub coarse: Vec<f64>,
    /// Derivatives of the moments by each parameter.
    pub slopes: Vec<Vec<f64>>,
    /// Covariance of the moments of samples times their number, by all replicates, in the first
    /// one; empty for others, and for data that are no samples.
    pub covariance: Vec<Vec<f64>>,
    /// Number of paths that failed.
    pub failed: u64,
}

/// Effort of an evaluation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Effort {
    /// Paths of a replicate.
    pub paths: u64,
    /// Factor of the number of steps.
    pub steps: u64,
}

impl Effort {
    /// Paths of all replicates.
    pub fn all_paths(&self) -> u64 {
        self.paths * REPLICATES
    }
}

/// A problem in which one parameter is changed a little.
pub struct NearbySetup<'a> {
    /// The problem, with the same scheme.
    pub setup: Setup<'a>,
    /// Change of the parameter.
    pub change: f64,
    /// The observables, which may depend on the parameter.
    pub observables: Vec<&'a dyn Observe>,
}

/// Paths of a problem and of nearby ones, with the observables of data.
pub struct Paths<'a> {
    setup: Setup<'a>,
    dimension: usize,
    observables: Vec<Vec<&'a dyn Observe>>,
    changes: Vec<f64>,
}

impl<'a> Paths<'a> {
    /// Paths of `setup` beside those `nearby`, until the last time of data.
    pub fn new(
        mut setup: Setup<'a>,
        until: f64,
        observables: Vec<&'a dyn Observe>,
        nearby: Vec<NearbySetup<'a>>,
    ) -> Self {
        let dimension = setup.problem.y0.len();
        let (mut all, mut near, mut changes) = (vec![observables], Vec::new(), Vec::new());
        for NearbySetup { setup: Setup { problem, scheme }, change, observables } in nearby {
            near.push(Near::new(&setup.problem, &problem, &scheme));
            all.push(observables);
            changes.push(change);
        }
        setup.scheme = SideBySide::of(&setup.scheme, &setup.problem, near);
        setup.problem.t_end = until;
        Self { setup, dimension, observables: all, changes }
    }

    /// Number of the fewest equal steps at whose ends all times of the data are.
    ///
    /// # Errors
    /// [`RunError::Setting`] if there are more than 4096.
    pub fn intervals(data: &Data) -> Result<u64, RunError> {
        (1..=INTERVALS)
            .find(|n| {
                data.moments.iter().all(|moment| {
                    let place = moment.time / data.until() * *n as f64;
                    (place - place.round()).abs() < OFF
                })
            })
            .ok_or_else(|| {
                RunError::Setting(format!(
                    "the times of the data are not multiples of t = {} over a number up to \
                 {INTERVALS}: round them",
                    data.until()
                ))
            })
    }

    /// Moments with their derivatives, of 32 replicates; `steps` steps times that of the effort are
    /// the fine ones.
    ///
    /// Paths are of a family of their own, independent of those of simulations with this key.
    ///
    /// # Errors
    /// [`RunError::Ladder`] if the scheme cannot be run, [`RunError::Stopped`] if `stop` asks for
    /// it.
    pub fn moments(
        &self,
        data: &Data,
        (steps, effort): (u64, &Effort),
        (key, truncation): (StreamKey, Truncation),
        (stop, told): (&Stop, &(dyn Fn(u64) + Sync)),
    ) -> Result<Vec<Replicate>, RunError> {
        let (fine, family) = (steps * effort.steps, (key, Purpose::Pilot));
        let ladder = self
            .setup
            .ladder(fine, 1, truncation, family, effort.all_paths())?
            .with_start()
            .telling(told);
        let step = |time: f64| (time / data.until() * ladder.coarse_steps() as f64).round() as u64;
        let length = 2 + self.changes.len();
        let mut cells: Vec<Cell<'_, 'a>> = Vec::new();
        let mut places = Vec::new();
        for moment in &data.moments {
            let (time, of) = (step(moment.time), moment.of);
            let known = cells.iter().position(|cell| (cell.time, cell.of) == (time, of));
            let place = known.unwrap_or_else(|| {
                let first = cells.iter().all(|cell| cell.time != time);
                let joint = CrossMoments::new(2 * self.observables[0].len());
                let joint = Some(joint).filter(|_| first && !data.observations.is_empty());
                let moments = CrossMoments::new(length);
                cells.push(Cell { paths: self, time, of, moments, rows: None, joint });
                cells.len() - 1
            });
            if moment.is_quantile() {
                cells[place].rows = Some(Vec::new());
            }
            places.push(place);
        }
        let replicate = |number: u64| {
            let first = number * effort.paths;
            let found = ladder.run_until(stop, first, effort.paths, || cells.clone());
            let mut rows = vec![Vec::new(); length];
            for (moment, &place) in data.moments.iter().zip(&places) {
                let all = found.statistic[place].of(moment.statistic, length);
                rows.iter_mut().zip(all).for_each(|(row, x)| row.push(x));
            }
            let slopes = rows.split_off(2);
            let coarse = rows.pop().unwrap_or_default();
            let values = rows.pop().unwrap_or_default();
            let (covariance, failed) = (Vec::new(), found.failed);
            let joints: Vec<_> = found
                .statistic
                .into_iter()
                .filter_map(|cell| Some((cell.time, cell.joint?)))
                .collect();
            (Replicate { values, coarse, slopes, covariance, failed }, joints)
        };
        let all: Vec<_> = (0..REPLICATES).into_par_iter().map(replicate).collect();
        if stop.is_asked() {
            return Err(RunError::Stopped);
        }
        let (mut all, joints): (Vec<_>, Vec<_>) = all.into_iter().unzip();
        let joints = joints.into_iter().reduce(|mut sums, more| {
            sums.iter_mut().zip(&more).for_each(|(sum, more)| sum.1.merge(&more.1));
            sums
        });
        let joint = |time| Some(&joints.as_ref()?.iter().find(|joint| joint.0 == time)?.1);
        let entry = |a: &Moment, b: &Moment| match joint(step(a.time)) {
            Some(joint) if a.time == b.time => together(joint, a, b),
            _ => 0.0,
        };
        let row = |a| data.moments.iter().map(|b| entry(a, b)).collect();
        all[0].covariance = data.moments.iter().take(data.observations.len()).map(row).collect();
        Ok(all)
    }
}

/// Values of an observable at a time: by fine steps, by coarse ones, and derivatives.
#[derive(Clone)]
struct Cell<'b, 'a> {
    paths: &'b Paths<'a>,
    /// Number of coarse steps.
    time: u64,
    of: usize,
    moments: CrossMoments,
    /// Moments of all observables and their squares, in the first cell of a time.
    joint: Option<CrossMoments>,
    /// Values of all paths, for quantiles.
    rows: Option<Vec<f64>>,
}

impl mc::Statistic for Cell<'_, '_> {
    fn observe(&mut self, view: &View<'_>) {
        if view.time != self.time {
            return;
        }
        let Paths { dimension, observables, changes, .. } = self.paths;
        let [coarse, fine] = [0, 1].map(|run| view.state(run));
        let value = |state: &[Row], k: usize| {
            let rows = &state[k * dimension..(k + 1) * dimension];
            observables[k][self.of].values(rows, view.live)
        };
        if let Some(joint) = &mut self.joint {
            let values: Vec<Row> = observables[0]
                .iter()
                .map(|phi| phi.values(&fine[..*dimension], view.live))
                .collect();
            let mut row = Vec::new();
            for p in view.live.paths() {
                row.clear();
                row.extend(values.iter().flat_map(|values| [values[p], values[p] * values[p]]));
                joint.add(&row);
            }
        }
        let own = value(fine, 0);
        let mut all = vec![own, value(coarse, 0)];
        for (k, change) in changes.iter().enumerate() {
            let near = value(fine, k + 1);
            all.push(std::array::from_fn(|p| (near[p] - own[p]) / change));
        }
        let mut row = vec![0.0; all.len()];
        for p in view.live.paths() {
            row.iter_mut().zip(&all).for_each(|(x, values)| *x = values[p]);
            self.moments.add(&row);
            self.rows.iter_mut().for_each(|rows| rows.extend(&row));
        }
    }

    fn merge(&mut self, later: Self) {
        self.moments.merge(&later.moments);
        self.joint.iter_mut().zip(&later.joint).for_each(|(joint, more)| joint.merge(more));
        self.rows.iter_mut().zip(later.rows).for_each(|(rows, more)| rows.extend(more));
    }
}

impl Cell<'_, '_> {
    /// The statistic by fine steps, by coarse ones, and its derivatives.
    fn of(&self, statistic: Statistic, length: usize) -> Vec<f64> {
        let (moments, n) = (&self.moments, self.moments.count() as f64);
        let covariance = |i, j| n * moments.covariance_of_means(i, j);
        match (statistic, &self.rows) {
            (Statistic::Variance, _) => {
                let slopes = (2..length).map(|k| 2.0 * covariance(0, k));
                [covariance(0, 0), covariance(1, 1)].into_iter().chain(slopes).collect()
            }
            (Statistic::Quantile(level), Some(rows)) if rows.len() > length => {
                quantile(&rows.chunks(length).collect::<Vec<_>>(), level, length)
            }
            _ => moments.means(),
        }
    }
}

/// Covariance of the influences of two moments, x − E x or (x − E x)² − Var x.
fn together(joint: &CrossMoments, a: &Moment, b: &Moment) -> f64 {
    let parts = |moment: &Moment| match moment.statistic {
        Statistic::Variance => {
            vec![(2 * moment.of + 1, 1.0), (2 * moment.of, -2.0 * joint.mean(2 * moment.of))]
        }
        _ => vec![(2 * moment.of, 1.0)],
    };
    let mut sum = 0.0;
    for (i, x) in parts(a) {
        for (j, y) in parts(b) {
            sum += x * y * joint.covariance_of_means(i, j);
        }
    }
    sum * joint.count() as f64
}

/// A quantile by fine steps, by coarse ones, and its derivatives E\[∂φ | φ = q\]: means over the
/// paths whose ranks are next to that of the quantile.
///
/// Of n values it is that of rank (n + ⅓)p + ⅓, whose median has no bias to second order (Hyndman
/// and Fan, *Am. Stat.* 50, 1996).
fn quantile(rows: &[&[f64]], level: f64, length: usize) -> Vec<f64> {
    let n = rows.len();
    let rank = ((n as f64 + 1.0 / 3.0) * level + 1.0 / 3.0).clamp(1.0, n as f64 - 1e-9) - 1.0;
    let (below, part) = (rank.floor() as usize, rank.fract());
    let sorted = |column: usize| {
        let mut order = rows.to_vec();
        order.sort_by(|a, b| a[column].total_cmp(&b[column]));
        order
    };
    let between = |column: usize, order: &[&[f64]]| {
        let next = (below + 1).min(n - 1);
        order[below][column] * (1.0 - part) + order[next][column] * part
    };
    let fine = sorted(0);
    // Neighbours on either side: noise and the change of the mean over them balance.
    let most = (0.5 * elementary::cbrt((n * n) as f64)) as usize;
    let near = most.min(below.min(n - 1 - below) / 2).max(1);
    let close = &fine[below.saturating_sub(near)..(below + near + 1).min(n)];
    let slope = |k: usize| close.iter().map(|row| row[k]).sum::<f64>() / close.len() as f64;
    let values = [between(0, &fine), between(1, &sorted(1))];
    values.into_iter().chain((2..length).map(slope)).collect()
}
