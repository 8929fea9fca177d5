//! Orders within a budget: more paths or finer steps, whatever would decide.

use mc::{LadderError, Observable};
use schemes::Scheme;
use systems::{Damping, PoissonSystem, Problem};

use super::{Decision, Limit, Order, ReferenceSolution, StepSizes, strong_order, weak_order};

/// [`strong_order`] with more paths or finer steps, whatever would decide, until an order is named
/// or the next measurement would exceed `path_steps` in all.
///
/// # Errors
/// As [`strong_order`].
pub fn strong_order_within<S, G, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    sizes: &StepSizes,
    path_steps: u64,
) -> Result<Order, LadderError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    within(sizes, path_steps, &|sizes| strong_order(scheme, problem, sizes))
}

/// The same for [`weak_order`].
///
/// # Errors
/// As [`weak_order`].
pub fn weak_order_within<S, G, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    observable: Observable<D>,
    sizes: &StepSizes,
    reference: &ReferenceSolution<'_, S, D, M>,
    path_steps: u64,
) -> Result<Order, LadderError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    within(sizes, path_steps, &|sizes| weak_order(scheme, problem, observable, sizes, reference))
}

/// Measures until an order is named, none can be, or the budget is spent.
fn within(
    sizes: &StepSizes,
    path_steps: u64,
    measure: &dyn Fn(&StepSizes) -> Result<Order, LadderError>,
) -> Result<Order, LadderError> {
    let (mut sizes, mut spent) = (*sizes, 0u64);
    loop {
        let order = measure(&sizes)?;
        spent = spent.saturating_add(sizes.cost());
        match order.decision {
            Decision::Order { .. } | Decision::WrongLimit => return Ok(order),
            Decision::LimitUnclear if order.limit == Limit::Unchecked => return Ok(order),
            Decision::NoDifferences | Decision::Wide { .. } | Decision::Hidden { .. } => {
                sizes.samples *= 4;
            }
            _ => sizes.coarsest_steps *= 4,
        }
        if spent.saturating_add(sizes.cost()) > path_steps || sizes.check().is_err() {
            return Ok(order);
        }
    }
}
