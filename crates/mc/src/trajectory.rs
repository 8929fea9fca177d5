//! One path, kept.

use noise::{StreamKey, Truncation};
use schemes::Scheme;
use systems::{Damping, PoissonSystem, Problem};

use crate::follow::{Drawn, follow};
use crate::{LadderError, PathFailure};

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
    if steps == 0 {
        return Err(LadderError::Steps { steps, multiple_of: 1 });
    }
    let tau = problem.t_end / steps as f64;
    let mut noise = Drawn::new(key, path, tau, scheme.needs_areas())?;
    let mut trajectory = Trajectory { times: vec![0.0], states: vec![problem.y0], failure: None };
    let halt = follow(problem, scheme, steps, truncation, &mut noise, |n, _, y| {
        trajectory.times.push(n as f64 * tau);
        trajectory.states.push(y);
    })?;
    trajectory.failure = halt.map(|(step, cause)| PathFailure {
        path,
        key,
        scheme: scheme.id(),
        swapped: false,
        tau,
        step,
        cause,
    });
    Ok(trajectory)
}
