//! Runs of a scheme at several step sizes, and states that paths visit.

use mc::{
    Kept, Ladder, LadderError, Measured, PathFailure, Setup, Statistic, View,
    parts::{Job, Stop},
};

use real::{Row, golden};

use super::StepSizes;

/// Computes a statistic over a number of paths; with a job, as work under the given name and number
/// of paths. The statistic has no path if the job met an error.
pub fn kept<T: Kept>(
    ladder: &Ladder<'_>,
    (job, stop): (Option<&Job>, &Stop),
    name: &str,
    samples: u64,
    new: impl Fn() -> T + Sync,
) -> Measured<T> {
    let Some(job) = job else { return ladder.run_until(stop, 0, samples, new) };
    let found = ladder.run_in_until(job, stop, &format!("{name}, {samples} paths"), samples, &new);
    found.unwrap_or_else(|| ladder.run(0, new))
}

/// State of a path at a time.
#[derive(Clone, Debug)]
pub struct Visit {
    pub t: f64,
    pub state: Vec<f64>,
}

/// States of a number of paths of the scheme, each at a time of its own, or y₀ if no path survives;
/// and the first failure.
pub fn visits(
    setup: &Setup<'_>,
    sizes: &StepSizes,
    paths: u64,
) -> Result<(Vec<Visit>, Option<PathFailure>), LadderError> {
    let steps = sizes.coarsest_steps << (sizes.levels - 1);
    let ladder = sizes.ladder(setup, steps, 0, paths)?;
    let visit = |view: &View<'_>, p: usize| {
        let fraction = golden((view.first_path + p as u64) as f64);
        let time = (1 + (fraction * steps as f64) as u64).min(steps);
        let t = time as f64 * ladder.tau(0);
        (time == view.time).then(|| Visit { t, state: state(view.state(0), p) })
    };
    let new = || Collected { of: &visit, found: Vec::new() };
    let measured = ladder.run_until(&sizes.stop, 0, paths, new);
    let mut visits = measured.statistic.found;
    if visits.is_empty() {
        visits.push(Visit { t: 0.0, state: state(&setup.start(), 0) });
    }
    Ok((visits, measured.failures.into_iter().next()))
}

/// The state of path `p` of a block.
pub fn state(rows: &[Row], p: usize) -> Vec<f64> {
    rows.iter().map(|row| row[p]).collect()
}

/// Collector of the values that `of` gives for live paths p of a block.
pub struct Collected<'a, T> {
    pub of: &'a (dyn Fn(&View<'_>, usize) -> Option<T> + Sync),
    pub found: Vec<T>,
}

impl<T: Send> Statistic for Collected<'_, T> {
    fn observe(&mut self, view: &View<'_>) {
        self.found.extend(view.live.paths().filter_map(|p| (self.of)(view, p)));
    }

    fn merge(&mut self, later: Self) {
        self.found.extend(later.found);
    }
}
