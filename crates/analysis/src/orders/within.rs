//! Orders within a budget: more paths or finer steps, whatever would decide.

use mc::LadderError;
use real::WIDTH;

use super::{Decision, Limit, More, Order, StepSizes};

/// Paths of a measurement at least: a block.
const FEWEST: u64 = WIDTH as u64;

/// Measures with more paths or finer steps, whatever would decide, until an order is named, none
/// can be, or the next measurement would exceed the [budget](StepSizes::within).
pub fn within(
    sizes: &StepSizes,
    measure: &dyn Fn(&StepSizes) -> Result<Order, LadderError>,
) -> Result<Order, LadderError> {
    let (mut sizes, mut spent) = (sizes.clone(), 0u64);
    if sizes.path_steps > 0 && sizes.check(1).is_ok() {
        let of_a_path = sizes.cost() / sizes.samples.max(1);
        sizes.samples = sizes.samples.min((sizes.path_steps / of_a_path.max(1)).max(FEWEST));
    }
    loop {
        let order = measure(&sizes)?;
        spent = spent.saturating_add(sizes.cost());
        match order.decision {
            _ if sizes.stop.is_asked() => return Ok(order),
            Decision::Undecided { more: More::Paths, .. } => {
                sizes.samples = sizes.samples.saturating_mul(4);
            }
            // Where single steps show no limit, those of finer measurements do not.
            Decision::Undecided { .. }
                if order.rate.is_none() || order.limit != Limit::Unchecked =>
            {
                sizes.coarsest_steps = sizes.coarsest_steps.saturating_mul(4);
            }
            _ => return Ok(order),
        }
        if spent.saturating_add(sizes.cost()) > sizes.path_steps || sizes.check(1).is_err() {
            return Ok(order);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use noise::{StreamKey, Truncation};
    use stats::Rate;

    use super::{super::decision::undecided, *};

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
            let (decision, limit) = decisions[asked.len().min(decisions.len() - 1)].clone();
            asked.push((sizes.coarsest_steps, sizes.samples));
            let (rate, one_step) = (Some(Rate::default()), None);
            Ok(Order { points: Vec::new(), rate, one_step, limit, decision, failed: 0 })
        });
        assert!(order.is_ok());
        asked.into_inner()
    }

    #[test]
    fn more_paths_or_finer_steps_follow_until_it_is_decided() {
        let limit = Limit::Consistent { defect: 0.0 };
        let [paths, steps] = [More::Paths, More::Steps].map(|more| (undecided(more, ""), limit));
        let two = |decision: &(Decision, Limit)| {
            measured(std::slice::from_ref(decision), u64::MAX / 2)[..2].to_vec()
        };
        assert_eq!((two(&paths)[1], two(&steps)[1]), ((3, 40), (12, 10)));
        for last in [Decision::Order { order: 1.0, shown: true }, Decision::WrongLimit] {
            let decisions = [paths.clone(), steps.clone(), (last, limit)];
            assert_eq!(measured(&decisions, u64::MAX), [(3, 10), (3, 40), (12, 40)]);
        }
        // Where the limit cannot be told finer steps are of no use.
        assert_eq!(measured(&[(steps.0, Limit::Unchecked)], u64::MAX), [(3, 10)]);
    }

    #[test]
    fn the_first_measurement_has_the_paths_of_its_budget() {
        let key = StreamKey { seed: 1, experiment: 1 };
        let sizes =
            StepSizes { levels: 2, refinement: 0, ..StepSizes::new(3, Truncation::none(), key) };
        let paths = |path_steps| {
            let asked = RefCell::new(0);
            let order = within(&sizes.clone().within(path_steps), &|sizes| {
                *asked.borrow_mut() = sizes.samples;
                let (rate, one_step, points) = (None, None, Vec::new());
                let (limit, decision) = (Limit::Unchecked, Decision::WrongLimit);
                Ok(Order { points, rate, one_step, limit, decision, failed: 0 })
            });
            assert!(order.is_ok());
            asked.into_inner()
        };
        // Of 12 steps each; one measurement without a budget.
        assert_eq!([0, 1, 611, 1_000_000].map(paths), [1000, 32, 50, 1000]);
    }

    #[test]
    fn a_budget_counts_what_was_spent_and_what_comes_next() {
        // 10·2·6 path-steps, then four times as many, 600 in all, and 2520 with the next.
        let decisions = [(undecided(More::Paths, ""), Limit::Consistent { defect: 0.0 })];
        let number = |path_steps| measured(&decisions, path_steps).len();
        assert_eq!([1, 599, 600, 2519, 2520].map(number), [1, 1, 2, 2, 3]);
    }
}
