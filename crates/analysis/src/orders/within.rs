//! Orders within a budget: more paths or finer steps, whatever would decide.

use mc::LadderError;

use super::{Decision, Limit, Order, StepSizes};

/// Measures with more paths or finer steps, whatever would decide, until an order is named, none
/// can be, or the next measurement would exceed the [budget](StepSizes::within).
pub fn within(
    sizes: &StepSizes,
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
                sizes.samples = sizes.samples.saturating_mul(4);
            }
            _ => sizes.coarsest_steps = sizes.coarsest_steps.saturating_mul(4),
        }
        if spent.saturating_add(sizes.cost()) > sizes.path_steps || sizes.check().is_err() {
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
        let order = within(&sizes.within(path_steps), &|sizes| {
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
