//! Step sizes, paths and noise of a measurement, and orders within a budget.

use std::sync::Arc;

use mc::{
    DampingResolution, DriveResolution, Ladder, LadderError, Setup,
    parts::{Job, Stop},
};
use noise::{Purpose, StreamKey, Truncation};
use real::WIDTH;

use super::{Decision, Limit, More, Order};

/// Step sizes, paths and noise of a measurement of an order.
///
/// [`StepSizes::new`] has cheap defaults.
#[derive(Clone, Debug)]
pub struct StepSizes {
    /// Number of steps on [0, T] at the coarsest step size.
    pub coarsest_steps: u64,
    /// Number of step sizes of the errors, each half of the one before.
    pub levels: usize,
    /// Number of step sizes beyond the finest of the errors; the last is the reference.
    pub refinement: u32,
    /// Number of paths.
    pub samples: u64,
    /// Truncation of increments.
    pub truncation: Truncation,
    /// Key of the noise.
    pub key: StreamKey,
    /// Budget of path-steps of all measurements together, see [`within`](Self::within).
    pub path_steps: u64,
    /// Stop signal that ends the measurement early: the result is then of no use.
    pub stop: Stop,
    /// Job that stores measurements, by their steps and paths, if there is one.
    pub job: Option<Arc<Job>>,
}

/// Largest number of step sizes: 2⁴⁸ steps would take years.
const MAX_SIZES: usize = 48;

impl StepSizes {
    /// Settings with five step sizes from T/`coarsest_steps` on, two beyond, and 1000 paths: some
    /// 250 000 steps for each of the coarsest.
    pub fn new(coarsest_steps: u64, truncation: Truncation, key: StreamKey) -> Self {
        Self {
            coarsest_steps,
            levels: 5,
            refinement: 2,
            samples: 1000,
            truncation,
            key,
            path_steps: 0,
            stop: Stop::default(),
            job: None,
        }
    }

    /// Sets a budget: measurements are repeated with more paths or finer steps, whatever would
    /// decide, until an order is named or the next one would exceed `path_steps` in all. The first
    /// has fewer paths where it would exceed the budget, but at least 32. Without a budget there is
    /// one measurement.
    #[must_use]
    pub fn within(self, path_steps: u64) -> Self {
        Self { path_steps, ..self }
    }

    /// The level above the finest of step size number `index`, coarsest first.
    pub(crate) fn level(&self, index: usize) -> usize {
        self.levels - 1 - index + self.refinement as usize
    }

    /// Number of steps of the reference.
    pub fn reference_steps(&self) -> u64 {
        self.coarsest_steps << self.level(0)
    }

    /// Number of step sizes, those beyond the finest included.
    pub(super) fn sizes(&self) -> usize {
        self.level(0) + 1
    }

    /// All step sizes, those beyond the finest included.
    pub(super) fn taus(&self, t_end: f64) -> Vec<f64> {
        (0..self.sizes()).map(|index| t_end / (self.coarsest_steps << index) as f64).collect()
    }

    /// Path-steps of a scheme at all step sizes.
    pub(super) fn cost(&self) -> u64 {
        self.samples.saturating_mul(2 * self.reference_steps())
    }

    /// Ladder of a scheme with the given number of finest steps on the given levels; see
    /// [`Setup::ladder`].
    pub(super) fn ladder<'a>(
        &self,
        setup: &Setup<'a>,
        steps: u64,
        levels: usize,
        paths: u64,
    ) -> Result<Ladder<'a>, LadderError> {
        setup.ladder(steps, levels, self.truncation, (self.key, Purpose::Paths), paths)
    }

    /// Message if the finest steps do not resolve the damping or H(t).
    pub(super) fn unresolved(&self, setup: &Setup<'_>) -> Option<String> {
        let damping = DampingResolution::new(setup, self.coarsest_steps);
        if let Some(by) = damping.unresolved(self.sizes() - 1) {
            return Some(format!("the steps resolve the damping to {by:.1e} only"));
        }
        let t = DriveResolution::new(&setup.problem).unresolved(self.reference_steps())?;
        Some(format!("the steps do not resolve a function of t near t = {t:.4}"))
    }

    /// Rejects sizes without a step, with fewer than `from` step sizes, or with too many of either.
    pub(super) fn check(&self, from: usize) -> Result<(), LadderError> {
        let given = self.levels.saturating_add(self.refinement as usize);
        if self.levels == 0 || !(from..=MAX_SIZES).contains(&given) {
            return Err(LadderError::StepSizes { given, from, to: MAX_SIZES });
        }
        let steps = self.coarsest_steps;
        if steps == 0 || steps.leading_zeros() <= self.level(0) as u32 {
            return Err(LadderError::Steps { steps, multiple_of: 1 });
        }
        Ok(())
    }
}

/// Least number of paths of a measurement: one block.
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
