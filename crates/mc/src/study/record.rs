//! Everything that the result of a study depends on.

use serde::{Deserialize, Serialize};

use super::StudySettings;
use crate::{Observe, RunError, Setup, observable::value};

/// Everything that the result of a study depends on. Systems and damping are described by
/// [`PoissonSystem::name`](systems::PoissonSystem::name),
/// [`PoissonSystem::parameters`](systems::PoissonSystem::parameters) and
/// [`Damping::describe`](systems::Damping::describe).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Version of this crate.
    pub version: String,
    /// Name of the system.
    pub system: String,
    /// Its parameters, as far as it describes them.
    pub parameters: String,
    /// Formula of γ.
    pub damping: String,
    /// The initial value y(0); one that may occur, if they are random.
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
    /// Number of paths, of those that failed too.
    pub paths: u64,
    /// Number of paths of the pilot that chose the bins.
    pub pilot: u64,
    /// Levels of the quantiles, in increasing order.
    pub quantiles: Vec<f64>,
    /// Names of the observables.
    pub observables: Vec<String>,
    /// Their values at t = 0; `None` for one that is not finite.
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
        let mut quantiles = settings.quantiles.clone();
        quantiles.sort_by(f64::total_cmp);
        let rows = setup.start();
        let initial = observables.iter().map(|observable| value(*observable, &rows));
        let start = problem.initial.as_ref();
        Ok(Self {
            version: env!("CARGO_PKG_VERSION").into(),
            system: problem.name.clone(),
            parameters: problem.parameters.clone(),
            damping: problem.describe_damping(),
            y0: problem.y0.clone(),
            start: start.map(|initial| initial.law.clone()),
            t_end: problem.t_end,
            scheme: scheme.id().into(),
            truncation: settings.truncation.order(),
            steps: settings.steps,
            times: start.map(|_| 0).into_iter().chain(settings.time_steps()?).collect(),
            seed: settings.key.seed,
            experiment: settings.key.experiment,
            paths: settings.paths,
            pilot: settings.pilot,
            quantiles,
            observables: observables.iter().map(|observable| observable.name().into()).collect(),
            initial: initial.map(|value| value.is_finite().then_some(value)).collect(),
        })
    }

    /// The time at the end of a step.
    pub(super) fn time(&self, step: u64) -> f64 {
        step as f64 * (self.t_end / self.steps as f64)
    }
}
