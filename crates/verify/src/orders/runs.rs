//! Runs of a scheme at several step sizes, and moments of what is made of their final states.

use std::sync::Arc;

use mc::{DynProblem, DynRun, Ladder, LadderError, Observable, TimeChange, View};
use noise::{BlockNoise, StepNoise};
use schemes::DynScheme;
use stats::CrossMoments;
use systems::{Damping, PoissonSystem, Problem};

use super::{Exact, StepSizes};
use crate::{FinalMoments, FinalRows};

/// The scheme at every step size, coarsest first.
pub fn at_all_sizes<'a, N>(
    scheme: &Arc<dyn DynScheme<N> + 'a>,
    sizes: &StepSizes,
) -> Vec<DynRun<'a, N>> {
    let run = |index| DynRun::new(Arc::clone(scheme), sizes.sizes() - 1 - index);
    (0..sizes.sizes()).map(run).collect()
}

/// Moments of a vector of this length at the final time, and the number of paths that were left
/// out.
pub fn measure<'a, N: StepNoise>(
    problem: &DynProblem<'a>,
    sizes: &StepSizes,
    runs: Vec<DynRun<'a, N>>,
    time_change: Option<&'a dyn TimeChange>,
    length: usize,
    values: &FinalRows<'_>,
) -> Result<(CrossMoments, u64), LadderError> {
    sizes.check()?;
    let (steps, top) = (sizes.reference_steps(), sizes.level(0));
    let mut ladder = Ladder::of(problem, steps, top, sizes.truncation, sizes.key, runs)?;
    if let Some(time_change) = time_change {
        ladder = ladder.with_time_change(time_change);
    }
    let none = || FinalMoments::of_rows(ladder.coarse_steps(), length, values);
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
    let values = |view: &View<'_>, values: &mut [real::Row]| {
        for p in view.live.paths() {
            values[0][p] = (observable.function)((exact.solution)(view.random_time[p]));
        }
    };
    let (problem, runs) = (DynProblem::of(problem), Vec::<DynRun<'_, BlockNoise<M>>>::new());
    let (values, _) = measure(&problem, sizes, runs, Some(exact.time_change), 1, &values)?;
    Ok((values.mean(0), values.covariance_of_means(0, 0).sqrt()))
}
