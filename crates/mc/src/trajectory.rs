//! One path, kept.

use noise::{StreamKey, Truncation};
use schemes::Scheme;
use systems::{Damping, PoissonSystem, Problem};

use crate::{Ladder, LadderError, PathFailure, Run, Statistic, View};

/// The states of one path at t_n = nτ, n = 0 … N; fewer when a step failed.
#[derive(Clone, Debug)]
pub struct Trajectory<const D: usize> {
    /// Times.
    pub times: Vec<f64>,
    /// States.
    pub states: Vec<[f64; D]>,
    /// Why it ends early, if it does.
    pub failure: Option<PathFailure>,
}

/// Follows path number `path` in `steps` steps to the final time of the problem.
/// [`Simulation`](crate::Simulation) does so with observables, for many paths, and into files.
///
/// # Errors
/// [`LadderError::Steps`] for zero steps, [`LadderError::Noise`] when the truncation is not defined
/// at T/steps, or when the scheme reads Lévy areas and no number of terms is large enough for them.
pub fn trajectory<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    problem: &Problem<S, G, D>,
    scheme: &dyn Scheme<S, D, M>,
    steps: u64,
    truncation: Truncation,
    key: StreamKey,
    path: u64,
) -> Result<Trajectory<D>, LadderError> {
    let ladder = Ladder::new(problem, steps, 0, truncation, key, vec![Run::new(scheme, 0)])?;
    let measured = ladder.run_from(path, 1, || States(Vec::new()), &|_| ());
    let mut states = vec![problem.y0];
    states.extend(measured.statistic.0);
    let times = (0..states.len()).map(|n| n as f64 * ladder.tau(0)).collect();
    Ok(Trajectory { times, states, failure: measured.failures.into_iter().next() })
}

/// The states of the first path of a block.
struct States<const D: usize>(Vec<[f64; D]>);

impl<const D: usize> Statistic<D> for States<D> {
    fn observe(&mut self, view: &View<'_, D>) {
        if view.live.contains(0) {
            self.0.push(view.states[0].path(0));
        }
    }

    fn merge(&mut self, later: Self) {
        self.0.extend(later.0);
    }
}
