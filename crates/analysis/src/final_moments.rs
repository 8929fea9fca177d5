//! Moments of functions of the final states.

use mc::{Kept, Statistic, View};
use real::{Row, WIDTH};
use stats::CrossMoments;

/// Function that computes numbers from the final states of all runs on the live paths of a block.
pub type FinalRows<'a> = dyn Fn(&View<'_>, &mut [Row]) + Sync + 'a;

/// Means and covariances of numbers that depend on the final states of all runs on a path:
/// squared errors, defects of invariants, differences of test functions.
pub struct FinalMoments<'a> {
    /// Moments of the numbers.
    pub moments: CrossMoments,
    time: u64,
    values: &'a FinalRows<'a>,
    rows: Vec<Row>,
    /// The numbers of one path.
    numbers: Vec<f64>,
}

impl<'a> FinalMoments<'a> {
    /// Creates moments of no path yet; `values` fills `length` rows at coarse step number `time`,
    /// usually the last one.
    pub fn new(time: u64, length: usize, values: &'a FinalRows<'a>) -> Self {
        let (rows, numbers) = (vec![[0.0; WIDTH]; length], vec![0.0; length]);
        Self { moments: CrossMoments::new(length), time, values, rows, numbers }
    }
}

impl Statistic for FinalMoments<'_> {
    fn observe(&mut self, view: &View<'_>) {
        if view.time != self.time {
            return;
        }
        (self.values)(view, &mut self.rows);
        for p in view.live.paths() {
            self.numbers.iter_mut().zip(&self.rows).for_each(|(number, row)| *number = row[p]);
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
