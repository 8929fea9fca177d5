//! The states of one path.

use std::collections::BTreeMap;

use noise::{StreamKey, Truncation};
use schemes::Scheme;
use systems::{Damping, PoissonSystem, Problem};

use crate::{Ladder, LadderError, PathFailure, Run, Statistic, View};

/// The states y_n of one path at t_n = nτ, n = 0 … N. If a step fails, the states before it.
#[derive(Clone, Debug)]
pub struct Trajectory<const D: usize> {
    /// The times t_n.
    pub times: Vec<f64>,
    /// The states y_n.
    pub states: Vec<[f64; D]>,
    /// The failure, if a step failed.
    pub failure: Option<PathFailure>,
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
pub fn trajectory<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    problem: &Problem<S, G, D>,
    scheme: &dyn Scheme<S, D, M>,
    steps: u64,
    truncation: Truncation,
    key: StreamKey,
    path: u64,
) -> Result<Trajectory<D>, LadderError> {
    let ladder = Ladder::new(problem, steps, 0, truncation, key, vec![Run::new(scheme, 0)])?;
    let states = |view: &View<'_>| view.live.paths().map(|p| (p, view.path(0, p))).collect();
    let measured = ladder.run_from(path, 1, || PathRecords::new(&states), &|_| ());
    let mut states = vec![problem.y0()];
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
