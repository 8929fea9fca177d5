//! Moments of functions of the final states.

use mc::{Statistic, View};
use stats::CrossMoments;

/// Numbers made of the final states of all runs on one path; written into the slice.
pub type FinalValues<'a, const D: usize> = dyn Fn(&[[f64; D]], &mut [f64]) + Sync + 'a;

/// Means and covariances of numbers that depend on the final states of all runs on a path:
/// squared errors, defects of invariants, differences of test functions.
pub struct FinalMoments<'a, const D: usize> {
    last_time: u64,
    values: &'a FinalValues<'a, D>,
    moments: CrossMoments,
    states: Vec<[f64; D]>,
    numbers: Vec<f64>,
}

impl<'a, const D: usize> FinalMoments<'a, D> {
    /// No path yet; `values` fills a slice of the given length at the last of `coarse_steps`
    /// coarse steps.
    #[must_use]
    pub fn new(coarse_steps: u64, length: usize, values: &'a FinalValues<'a, D>) -> Self {
        Self {
            last_time: coarse_steps,
            values,
            moments: CrossMoments::new(length),
            states: Vec::new(),
            numbers: vec![0.0; length],
        }
    }

    /// Moments of the numbers.
    #[must_use]
    pub fn moments(&self) -> &CrossMoments {
        &self.moments
    }
}

impl<const D: usize> Statistic<D> for FinalMoments<'_, D> {
    fn observe(&mut self, view: &View<'_, D>) {
        if view.time < self.last_time {
            return;
        }
        for p in view.live.paths() {
            self.states.clear();
            self.states.extend(view.states.iter().map(|state| state.path(p)));
            (self.values)(&self.states, &mut self.numbers);
            self.moments.add(&self.numbers);
        }
    }

    fn merge(&mut self, later: Self) {
        self.moments.merge(&later.moments);
    }
}
