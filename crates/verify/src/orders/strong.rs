//! Strong orders.

use mc::{LadderError, View, squared_distance};
use schemes::Scheme;
use stats::fit_strong;
use systems::{Damping, PoissonSystem, Problem};

use super::{
    Measure, Order, ReferenceSolution, StepSizes, decision,
    errors::{differences, record, record_length, strong_points},
    limit::limit,
    one_step::one_step,
    runs::{at_all_sizes, measure},
    visits::visits,
};

/// Three differences and their order.
const LEAST_SIZES: usize = 4;

/// The strong order of `scheme`, with root-mean-square errors at the final time. The limit is
/// compared with that of an independent scheme.
///
/// # Errors
/// [`LadderError`] if there are fewer than four step sizes (`levels` + `refinement`) or no step, if
/// there are too many of either, or if the truncation is not defined at one of the step sizes.
pub fn strong_order<S, G, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    sizes: &StepSizes,
) -> Result<Order, LadderError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    strong_order_against(scheme, problem, sizes, &ReferenceSolution::Independent)
}

/// The same with a reference of one's own for the limit. Against an exact solution the points are
/// errors against it.
///
/// # Errors
/// As [`strong_order`].
pub fn strong_order_against<S, G, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    sizes: &StepSizes,
    reference: &ReferenceSolution<'_, S, D, M>,
) -> Result<Order, LadderError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    sizes.check_order(LEAST_SIZES)?;
    let (levels, number) = (sizes.levels, sizes.sizes());
    let (runs, exact) = (at_all_sizes(scheme, sizes), reference.exact());
    let values = |view: &View<'_>, p: usize, numbers: &mut [f64]| {
        let states: Vec<[f64; D]> = (0..view.runs()).map(|run| view.path(run, p)).collect();
        record(&states, levels, numbers);
        if let Some(exact) = exact {
            let solution = (exact.solution)(view.random_time[p]);
            for (number, state) in numbers.iter_mut().zip(&states[..levels]) {
                *number = squared_distance(*state, solution);
            }
        }
    };
    let time_change = exact.map(|exact| exact.time_change);
    let length = record_length(number, levels);
    let (moments, failed) = measure(problem, sizes, runs, time_change, length, &values)?;

    let taus = sizes.taus(problem.t_end());
    let mut rate = fit_strong(&taus[..number - 1], &differences(&moments, number, levels));
    let visits = visits(scheme, problem, sizes)?;
    let one_step = one_step(scheme, problem, sizes, &visits);
    let limit = limit(scheme, problem, sizes, &visits, reference, Measure::Strong)?;
    let decision = decision::obstacle(failed, sizes.samples, sizes.damping(scheme, problem))
        .unwrap_or_else(|| decision::strong(rate.as_ref(), one_step, limit));
    let points = match &mut rate {
        _ if exact.is_some() => stats::root_mean_squares(&taus[..levels], &moments),
        Some(rate) => {
            let fitted = rate.estimate;
            let orders = [decision.settle(rate), fitted, rate.lo, rate.hi];
            // Orders below ½ would make the tail as large as one likes.
            strong_points(&taus[..levels], &moments, &orders.map(|p| p.max(0.5)))
        }
        None => Vec::new(),
    };
    if let Some(rate) = rate.as_mut().filter(|_| exact.is_some()) {
        decision.settle(rate);
    }
    Ok(Order { points, rate, one_step, limit, decision, failed })
}
