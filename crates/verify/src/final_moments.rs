//! Moments of functions of the final states.

use mc::{Kept, Statistic, View};
use stats::CrossMoments;

/// Numbers made of the final states of all runs on one path of a block, written into the slice.
pub type FinalValues<'a> = dyn Fn(&View<'_>, usize, &mut [f64]) + Sync + 'a;

/// Means and covariances of numbers that depend on the final states of all runs on a path:
/// squared errors, defects of invariants, differences of test functions.
pub struct FinalMoments<'a> {
    /// Moments of the numbers.
    pub moments: CrossMoments,
    last_time: u64,
    values: &'a FinalValues<'a>,
    numbers: Vec<f64>,
}

impl<'a> FinalMoments<'a> {
    /// No path yet; `values` fills a slice of the given length at the last of `coarse_steps`
    /// coarse steps.
    pub fn new(coarse_steps: u64, length: usize, values: &'a FinalValues<'a>) -> Self {
        let (moments, numbers) = (CrossMoments::new(length), vec![0.0; length]);
        Self { moments, last_time: coarse_steps, values, numbers }
    }
}

impl Statistic for FinalMoments<'_> {
    fn observe(&mut self, view: &View<'_>) {
        if view.time < self.last_time {
            return;
        }
        for p in view.live.paths() {
            (self.values)(view, p, &mut self.numbers);
            self.moments.add(&self.numbers);
        }
    }

    fn merge(&mut self, later: Self) {
        self.moments.merge(&later.moments);
    }
}

impl Kept for FinalMoments<'_> {
    type Sums = CrossMoments;

    fn sums(&self) -> &CrossMoments {
        &self.moments
    }

    fn sums_mut(&mut self) -> &mut CrossMoments {
        &mut self.moments
    }
}
