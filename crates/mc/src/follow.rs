//! One path, step by step: whatever its increments come from and whatever is kept of it.

use noise::{AreaMethod, AreaPath, StreamKey, Truncation, WienerPath, strong_order_one_error};
use schemes::{Scheme, Step};
use systems::{Damping, PoissonSystem, Problem};

use crate::{Cause, LadderError};

/// The noise of one step, not truncated: increments and Lévy areas.
pub(crate) type StepNoise<const M: usize> = ([f64; M], [[f64; M]; M]);

/// Where the noise of the steps comes from.
pub(crate) trait NoiseSource<const M: usize> {
    /// The noise of the next step, of size `tau`.
    fn next(&mut self, tau: f64) -> StepNoise<M>;
}

/// The noise of a path of a family of streams.
pub(crate) struct Drawn<const M: usize> {
    increments: WienerPath<M>,
    areas: Option<AreaPath<M>>,
}

impl<const M: usize> Drawn<M> {
    /// With areas of an error that strong order one asks at step `tau`, if they are wanted.
    pub(crate) fn new(
        key: StreamKey,
        path: u64,
        tau: f64,
        with_areas: bool,
    ) -> Result<Self, LadderError> {
        let areas = if with_areas {
            let method = AreaMethod::MrongowiusRoessler;
            let terms = method.terms_for(strong_order_one_error(tau), tau, M)?;
            Some(AreaPath::new(key, path, method, terms))
        } else {
            None
        };
        Ok(Self { increments: WienerPath::new(key, path), areas })
    }
}

impl<const M: usize> NoiseSource<M> for Drawn<M> {
    fn next(&mut self, tau: f64) -> StepNoise<M> {
        let dw = self.increments.increments(tau.sqrt());
        (dw, self.areas.as_mut().map_or([[0.0; M]; M], |noise| noise.areas(tau, dw)))
    }
}

/// Takes `steps` steps to the final time. `keep` is told (n, ∫γ over the n-th step, yₙ) for n = 1,
/// 2, …; a step without a solution, or to a state that is not finite, is the last and is returned
/// with its number from 0.
pub(crate) fn follow<S, G, const D: usize, const M: usize>(
    problem: &Problem<S, G, D>,
    scheme: &dyn Scheme<S, D, M>,
    steps: u64,
    truncation: Truncation,
    source: &mut dyn NoiseSource<M>,
    mut keep: impl FnMut(u64, f64, [f64; D]),
) -> Result<Option<(u64, Cause)>, LadderError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    if steps == 0 {
        return Err(LadderError::Steps { steps, multiple_of: 1 });
    }
    let tau = problem.t_end / steps as f64;
    let (bound, area_bound) = (truncation.bound(tau)?, truncation.area_bound(tau)?);
    let mut y = problem.y0;
    for n in 0..steps {
        let step = Step::new(&problem.damping, n, tau)?;
        let (dw, areas) = source.next(tau);
        let dw = dw.map(|w| w.clamp(-bound, bound));
        let areas = areas.map(|row| row.map(|area| area.clamp(-area_bound, area_bound)));
        let solution = scheme.step_with_areas(&problem.system, &step, dw, areas, y);
        y = solution.z;
        if let nonlin::Outcome::Failed { residual } = solution.outcome {
            return Ok(Some((n, Cause::of_residual(residual))));
        }
        if y.iter().any(|component| !component.is_finite()) {
            return Ok(Some((n, Cause::NotFinite)));
        }
        keep(n + 1, step.damping_integral(), y);
    }
    Ok(None)
}
