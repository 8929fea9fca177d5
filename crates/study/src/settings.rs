//! Settings of a study, and everything that its result depends on.

use noise::{StreamKey, Truncation};
use real::Row;
use serde::{Deserialize, Serialize};
use stats::CentralMoments;

use super::{
    Wanted,
    dependence::{CELLS, OfPair},
    sums::FIRST_PATHS,
};
use mc::{GROUP_PATHS, Observe, RunError, Setup, demand, parts::Stop, value_at};

/// Settings of a [`Study`](super::Study).
#[derive(Clone, Debug)]
pub struct StudySettings {
    /// Number of steps on [0, T].
    pub steps: u64,
    /// The number of times at which observables are evaluated, evenly spaced; the last is T. It
    /// divides the number of steps. The initial value is in the result without being asked for.
    pub times: u64,
    /// Number of paths.
    pub paths: u64,
    /// Truncation of increments.
    pub truncation: Truncation,
    /// Seed and experiment of the streams, below 2⁴⁰. The pilot has [streams](noise::Purpose) of
    /// its own.
    pub key: StreamKey,
    /// The levels of the quantiles, between 0 and 1. Default 0.05, 0.25, 0.5, 0.75 and 0.95.
    pub quantiles: Vec<f64>,
    /// Bins of each histogram, from 2 to 65536. Default 256: for a normal law a bin is then a
    /// twentieth to a tenth of the standard deviation. A study keeps 2 bytes for each bin,
    /// observable and time in each group of 128 paths, and 8 groups per thread.
    pub bins: u32,
    /// Paths of the pilot that chooses the bins, at least 128. Default 1024. A study that is
    /// extended keeps its bins, and so its pilot.
    pub pilot: u64,
    /// Covariances, joint laws and autocorrelations; none unless set. Times are evenly spaced for
    /// the latter.
    pub wanted: Wanted,
    /// Flag that ends the pilot early; then nothing should be run.
    pub stop: Stop,
}

impl StudySettings {
    /// Default values for the settings that have one.
    pub fn new(steps: u64, times: u64, paths: u64, truncation: Truncation, key: StreamKey) -> Self {
        Self {
            steps,
            times,
            paths,
            truncation,
            key,
            quantiles: vec![0.05, 0.25, 0.5, 0.75, 0.95],
            bins: 256,
            pilot: 1024,
            wanted: Wanted::default(),
            stop: Stop::default(),
        }
    }

    /// Refuses statistics of `observables` observables that need more memory than is free.
    pub(super) fn demand(&self, observables: usize) -> Result<(), RunError> {
        let threads = rayon::current_num_threads() as f64;
        let groups = (self.paths as f64 / GROUP_PATHS as f64).max(1.0);
        // Groups under way and just done, nodes of the tree that wait for their neighbours, nodes
        // in the checkpoint, and the result, which is four times as wide.
        let nodes = f64::from((groups as u64).ilog2()) + 2.0;
        let sums = (2.0 * threads).min(groups) + 2.0 * nodes + 5.0;
        let (pairs, lagged) = (self.wanted.pairs.len(), self.wanted.lagged.len());
        let value = size_of::<CentralMoments>() + size_of::<u64>() + 2 * self.bins as usize;
        let at_a_time =
            observables * value + pairs * size_of::<OfPair>() + 5 * lagged * size_of::<Row>();
        let joint = pairs * CELLS * size_of::<u64>();
        let first = observables * FIRST_PATHS.min(self.paths) as usize * size_of::<f64>();
        let times = self.times as f64;
        let what =
            format!("statistics of {observables} observables and {pairs} pairs at {times} times");
        Ok(demand(what, sums * (times * at_a_time as f64 + (joint + first) as f64))?)
    }

    /// Checks all but the truncation.
    fn check(&self, observables: &[&dyn Observe]) -> Result<(), RunError> {
        let Self { steps, times, paths, bins, pilot, .. } = *self;
        let (some, number) = (!observables.is_empty(), observables.len() as f64);
        let few = (2..=1 << 16).contains(&bins);
        RunError::unmet([
            (steps > 0, "number of steps", "at least 1", steps as f64),
            (paths > 0, "number of paths", "at least 1", paths as f64),
            (few, "number of bins", "from 2 to 65536", f64::from(bins)),
            (pilot >= 128, "number of pilot paths", "at least 128", pilot as f64),
            (some, "number of observables", "at least 1", number),
        ])?;
        RunError::twice("observables", &names(observables))?;
        RunError::unmet(self.quantiles.iter().enumerate().map(|(n, level)| {
            let met = 0.0 < *level && *level < 1.0 && !self.quantiles[..n].contains(level);
            (met, "level of a quantile", "between 0 and 1, once each", *level)
        }))?;
        if times == 0 || !steps.is_multiple_of(times) {
            return Err(RunError::Setting(format!(
                "{steps} steps cannot be divided into {times} equal parts: take a number that \
                 divides them"
            )));
        }
        Ok(())
    }
}

fn names(observables: &[&dyn Observe]) -> Vec<String> {
    observables.iter().map(|observable| observable.name().into()).collect()
}

/// Everything that the result of a study depends on. Systems and damping are described by
/// `PoissonSystem::name`, `PoissonSystem::parameters` and `Damping::describe`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Version of this crate.
    pub version: String,
    /// Name of the system.
    pub system: String,
    /// Parameters of the system, as far as it describes them.
    pub parameters: String,
    /// Formula of γ.
    pub damping: String,
    /// The initial value y(0); one possible value if it is random.
    pub y0: Vec<f64>,
    /// The law of random initial values.
    pub start: Option<String>,
    /// The final time T.
    pub t_end: f64,
    /// Identifier of the scheme.
    pub scheme: String,
    /// Order k of the truncation of increments; `None` if they are not truncated.
    pub truncation: Option<u32>,
    /// Number of steps on [0, T].
    pub steps: u64,
    /// The steps at whose ends observables are evaluated, counted from 1; before the first of them
    /// zero, if initial values are random.
    pub times: Vec<u64>,
    /// Master seed.
    pub seed: u64,
    /// Number of the experiment.
    pub experiment: u64,
    /// Number of paths, failed ones included.
    pub paths: u64,
    /// Number of paths of the pilot that chose the bins.
    pub pilot: u64,
    /// Levels of the quantiles, in increasing order.
    pub quantiles: Vec<f64>,
    /// Names of the observables.
    pub observables: Vec<String>,
    /// Values of the observables at t = 0; `None` for one that is not finite.
    pub initial: Vec<Option<f64>>,
}

impl Record {
    pub(super) fn new(
        setup: &Setup<'_>,
        observables: &[&dyn Observe],
        settings: &StudySettings,
    ) -> Result<Self, RunError> {
        settings.check(observables)?;
        let Setup { problem, scheme } = setup;
        let StudySettings { steps, times, .. } = *settings;
        let mut quantiles = settings.quantiles.clone();
        quantiles.sort_by(f64::total_cmp);
        let rows = setup.start();
        let initial = observables.iter().map(|observable| value_at(*observable, &rows));
        let start = problem.initial.as_ref();
        Ok(Self {
            version: env!("CARGO_PKG_VERSION").into(),
            system: problem.name.clone(),
            parameters: problem.parameters.clone(),
            damping: problem.describe_damping(),
            y0: problem.y0.clone(),
            start: start.map(|initial| initial.law.clone()),
            t_end: problem.t_end,
            scheme: scheme.about().id.into(),
            truncation: settings.truncation.order(),
            steps,
            times: (start.map(|_| 0).into_iter())
                .chain((1..=times).map(|n| n * (steps / times)))
                .collect(),
            seed: settings.key.seed,
            experiment: settings.key.experiment,
            paths: settings.paths,
            pilot: settings.pilot,
            quantiles,
            observables: names(observables),
            initial: initial.map(|value| value.is_finite().then_some(value)).collect(),
        })
    }

    /// The time at the end of a step.
    pub(super) fn time(&self, step: u64) -> f64 {
        step as f64 * (self.t_end / self.steps as f64)
    }
}
