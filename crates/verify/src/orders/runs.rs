//! Runs of a scheme at several step sizes, and moments of what is made of their final states.

use mc::{Ladder, LadderError, Observable, Run, TimeChange, View};
use schemes::Scheme;
use stats::CrossMoments;
use systems::{Damping, PoissonSystem, Problem};

use super::{Exact, StepSizes};
use crate::{FinalMoments, FinalValues};

/// The scheme at every step size, coarsest first.
pub fn at_all_sizes<'a, S, const D: usize, const M: usize>(
    scheme: &'a dyn Scheme<S, D, M>,
    sizes: &StepSizes,
) -> Vec<Run<'a, S, D, M>> {
    (0..sizes.sizes()).map(|index| Run::new(scheme, sizes.sizes() - 1 - index)).collect()
}

/// Moments of a vector of this length at the final time, and the number of paths that were left
/// out.
pub fn measure<S, G, const D: usize, const M: usize>(
    problem: &Problem<S, G, D>,
    sizes: &StepSizes,
    runs: Vec<Run<'_, S, D, M>>,
    time_change: Option<&dyn TimeChange>,
    length: usize,
    values: &FinalValues<'_>,
) -> Result<(CrossMoments, u64), LadderError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    sizes.check()?;
    let (steps, top) = (sizes.reference_steps(), sizes.level(0));
    let mut ladder = Ladder::new(problem, steps, top, sizes.truncation, sizes.key, runs)?;
    if let Some(time_change) = time_change {
        ladder = ladder.with_time_change(time_change);
    }
    let none = || FinalMoments::new(ladder.coarse_steps(), length, values);
    let measured = ladder.run(sizes.samples, none, &|_| ());
    Ok((measured.statistic.moments, measured.failed))
}

/// Mean of φ over exact solutions on sampled paths, with its standard error.
///
/// # Errors
/// As [`strong_order`](super::strong_order).
pub fn exact_mean<S, G, const D: usize, const M: usize>(
    problem: &Problem<S, G, D>,
    observable: Observable<D>,
    sizes: &StepSizes,
    exact: Exact<'_, D>,
) -> Result<(f64, f64), LadderError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let values = |view: &View<'_>, p: usize, values: &mut [f64]| {
        values[0] = (observable.function)((exact.solution)(view.random_time[p]));
    };
    let (values, _) = measure(problem, sizes, Vec::new(), Some(exact.time_change), 1, &values)?;
    Ok((values.mean(0), values.covariance_of_means(0, 0).sqrt()))
}
