//! The states of one path.

use std::{collections::BTreeMap, sync::Arc};

use noise::{StreamKey, Truncation};

use crate::{Ladder, LadderError, PathFailure, Run, Setup, Statistic, View, parts::Stop};

/// The states y_n of one path at t_n = nτ, n = 0 … N. If a step fails, the states before it.
#[derive(Clone, Debug)]
pub struct Trajectory {
    /// The times t_n.
    pub times: Vec<f64>,
    /// The states y_n.
    pub states: Vec<Vec<f64>>,
    /// The failure, if a step failed.
    pub failure: Option<PathFailure>,
}

impl Trajectory {
    /// The state y_n.
    ///
    /// # Panics
    /// Unless D is the dimension, and y_n was reached.
    pub fn state<const D: usize>(&self, n: usize) -> [f64; D] {
        let state = &self.states[n];
        let dimension = state.len();
        state[..].try_into().unwrap_or_else(|_| panic!("a state has {dimension} numbers, not {D}"))
    }
}

/// Simulates path number `path` in `steps` steps to the final time of the problem.
/// [`Simulation`](crate::Simulation) also computes observables and writes files.
///
/// # Errors
/// [`LadderError::Steps`] for zero steps. [`LadderError::Noise`] if the truncation is undefined at
/// T/steps, or if the scheme reads Lévy areas and they need too many terms.
///
/// # Panics
/// As [`Ladder::run`].
pub fn trajectory(
    setup: &Setup<'_>,
    steps: u64,
    truncation: Truncation,
    key: StreamKey,
    path: u64,
) -> Result<Trajectory, LadderError> {
    let Setup { problem, scheme } = setup;
    let runs = vec![Run::new(Arc::clone(scheme), 0)];
    let ladder = Ladder::new(problem, steps, 0, truncation, key, runs)?;
    let state = |view: &View<'_>, p: usize| view.state(0).iter().map(|row| row[p]).collect();
    let states = |view: &View<'_>| view.live.paths().map(|p| (p, state(view, p))).collect();
    let measured =
        ladder.run_until(&Stop::default(), path, 1, || PathRecords::new(&states), &|_| ());
    let mut states: Vec<Vec<f64>> = vec![problem.y0.clone()];
    states.extend(measured.statistic.of_path.into_values().flatten());
    let times = (0..states.len()).map(|n| n as f64 * ladder.tau(0)).collect();
    Ok(Trajectory { times, states, failure: measured.failures.into_iter().next() })
}

/// The records of paths of a block at one time, each with the number of the path in the block.
type RecordBlock<'a, T> = dyn Fn(&View<'_>) -> Vec<(usize, T)> + Sync + 'a;

/// The records of every path.
pub(crate) struct PathRecords<'a, T> {
    record: &'a RecordBlock<'a, T>,
    pub(crate) of_path: BTreeMap<u64, Vec<T>>,
}

impl<'a, T> PathRecords<'a, T> {
    pub(crate) fn new(record: &'a RecordBlock<'a, T>) -> Self {
        Self { record, of_path: BTreeMap::new() }
    }
}

impl<T: Send> Statistic for PathRecords<'_, T> {
    fn observe(&mut self, view: &View<'_>) {
        for (p, record) in (self.record)(view) {
            self.of_path.entry(view.first_path + p as u64).or_default().push(record);
        }
    }

    fn merge(&mut self, later: Self) {
        self.of_path.extend(later.of_path);
    }
}
