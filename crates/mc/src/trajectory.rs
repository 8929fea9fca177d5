//! One path, kept.

use noise::{AreaMethod, AreaPath, StreamKey, Truncation, WienerPath, strong_order_one_error};
use schemes::{Scheme, Step};
use systems::{Damping, PoissonSystem, Problem};

use crate::{Cause, LadderError, PathFailure};

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
///
/// # Errors
/// [`LadderError::Steps`] for zero steps, [`LadderError::Noise`] when the truncation is not defined at T/steps, or when the
/// scheme reads Lévy areas and no number of terms is large enough for them.
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
    let (bound, area_bound) = (truncation.bound(tau)?, truncation.area_bound(tau)?);
    let mut noise = WienerPath::<M>::new(key, path);
    let mut area_noise = if scheme.needs_areas() {
        let method = AreaMethod::MrongowiusRoessler;
        let terms = method.terms_for(strong_order_one_error(tau), tau, M)?;
        Some(AreaPath::<M>::new(key, path, method, terms))
    } else {
        None
    };
    let mut y = problem.y0;
    let mut trajectory = Trajectory { times: vec![0.0], states: vec![y], failure: None };
    for n in 0..steps {
        let step = Step::new(&problem.damping, n, tau)?;
        let drawn = noise.increments(tau.sqrt());
        let areas = area_noise.as_mut().map_or([[0.0; M]; M], |noise| noise.areas(tau, drawn));
        let dw = drawn.map(|w| w.clamp(-bound, bound));
        let areas = areas.map(|row| row.map(|area| area.clamp(-area_bound, area_bound)));
        let solution = scheme.step_with_areas(&problem.system, &step, dw, areas, y);
        y = solution.z;
        let cause = match solution.outcome {
            nonlin::Outcome::Failed { residual } => Some(Cause::of_residual(residual)),
            _ if y.iter().any(|component| !component.is_finite()) => Some(Cause::NotFinite),
            _ => None,
        };
        if let Some(cause) = cause {
            trajectory.failure =
                Some(PathFailure { path, key, scheme: scheme.id(), swapped: false, tau, step: n, cause });
            break;
        }
        trajectory.times.push((n + 1) as f64 * tau);
        trajectory.states.push(y);
    }
    Ok(trajectory)
}
