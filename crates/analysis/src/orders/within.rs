//! Orders within a budget: more paths or finer steps, whatever would decide.

use mc::{LadderError, Observable, Observe, Setup};
use noise::StepNoise;
use schemes::Scheme;
use systems::{Damping, PoissonSystem, Problem};

use super::{
    Decision, DynReference, Limit, Order, ReferenceSolution, StepSizes, strong_order,
    strong_order_of, weak_order, weak_order_of,
};

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

/// The same as [`strong_order_within`] for a problem of any dimension.
///
/// # Errors
/// As [`strong_order`].
pub fn strong_order_of_within<N: StepNoise>(
    setup: &Setup<'_, N>,
    sizes: &StepSizes,
    reference: &DynReference<'_, N>,
    path_steps: u64,
) -> Result<Order, LadderError> {
    within(sizes, path_steps, &|sizes| strong_order_of(setup, sizes, reference))
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

/// The same as [`weak_order_within`] for a problem of any dimension.
///
/// # Errors
/// As [`weak_order`].
pub fn weak_order_of_within<N: StepNoise>(
    setup: &Setup<'_, N>,
    observable: &dyn Observe,
    sizes: &StepSizes,
    reference: &DynReference<'_, N>,
    path_steps: u64,
) -> Result<Order, LadderError> {
    within(sizes, path_steps, &|sizes| weak_order_of(setup, observable, sizes, reference))
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
            Decision::Order { .. } | Decision::WrongLimit | Decision::Kept => return Ok(order),
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

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use noise::{StreamKey, Truncation};

    use super::*;

    /// The numbers of steps and paths of all measurements whose decisions are these, in a budget.
    fn measured(decisions: &[(Decision, Limit)], path_steps: u64) -> Vec<(u64, u64)> {
        let key = StreamKey { seed: 1, experiment: 1 };
        let sizes = StepSizes {
            levels: 2,
            refinement: 0,
            samples: 10,
            ..StepSizes::new(3, Truncation::none(), key)
        };
        let asked = RefCell::new(Vec::new());
        let order = within(&sizes, path_steps, &|sizes| {
            let mut asked = asked.borrow_mut();
            let (decision, limit) = decisions[asked.len().min(decisions.len() - 1)];
            asked.push((sizes.coarsest_steps, sizes.samples));
            Ok(Order { points: Vec::new(), rate: None, one_step: None, limit, decision, failed: 0 })
        });
        assert!(order.is_ok());
        asked.into_inner()
    }

    #[test]
    fn more_paths_or_finer_steps_follow_until_it_is_decided() {
        let limit = Limit::Consistent { defect: 0.0 };
        let with = |decision| measured(&[(decision, limit)], u64::MAX / 2)[..2].to_vec();
        let wide = Decision::Wide { more_paths: 2.0 };
        for decision in [Decision::NoDifferences, wide, Decision::Hidden { share: 0.5 }] {
            assert_eq!(with(decision), [(3, 10), (3, 40)]);
        }
        for decision in [
            Decision::NotAsymptotic,
            Decision::OneStepUnclear,
            Decision::Failures { all: true, t: 1.0 },
            Decision::Damping { defect: 1.0 },
            Decision::LimitUnclear,
        ] {
            assert_eq!(with(decision), [(3, 10), (12, 10)]);
        }
        let order = Decision::Order { order: 1.0, shown: true };
        for last in [order, Decision::WrongLimit] {
            let decisions =
                [(wide, limit), (Decision::Failures { all: false, t: 1.0 }, limit), (last, limit)];
            assert_eq!(measured(&decisions, u64::MAX), [(3, 10), (3, 40), (12, 40)]);
        }
        // Without another scheme finer steps are of no use.
        assert_eq!(measured(&[(Decision::LimitUnclear, Limit::Unchecked)], u64::MAX), [(3, 10)]);
    }

    #[test]
    fn a_budget_counts_what_was_spent_and_what_comes_next() {
        // 10·2·6 path-steps, then four times as many, 600 in all, and 2520 with the next.
        let decisions = [(Decision::NoDifferences, Limit::Consistent { defect: 0.0 })];
        let number = |path_steps| measured(&decisions, path_steps).len();
        assert_eq!([1, 599, 600, 2519, 2520].map(number), [1, 1, 2, 2, 3]);
    }
}
