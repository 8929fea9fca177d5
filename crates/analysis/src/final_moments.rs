//! Moments of functions of the final states.

use mc::{Kept, Statistic, View};
use real::{Row, WIDTH};
use stats::CrossMoments;

/// Numbers made of the final states of all runs on one path of a block, written into the slice.
pub type FinalValues<'a> = dyn Fn(&View<'_>, usize, &mut [f64]) + Sync + 'a;

/// The same for all paths of a block that are live, written into rows.
pub type FinalRows<'a> = dyn Fn(&View<'_>, &mut [Row]) + Sync + 'a;

/// Means and covariances of numbers that depend on the final states of all runs on a path:
/// squared errors, defects of invariants, differences of test functions.
pub struct FinalMoments<'a> {
    /// Moments of the numbers.
    pub moments: CrossMoments,
    last_time: u64,
    values: Values<'a>,
    numbers: Vec<f64>,
}

enum Values<'a> {
    Path(&'a FinalValues<'a>),
    Block(&'a FinalRows<'a>, Vec<Row>),
}

impl<'a> FinalMoments<'a> {
    /// No path yet; `values` fills a slice of the given length at the last of `coarse_steps`
    /// coarse steps.
    pub fn new(coarse_steps: u64, length: usize, values: &'a FinalValues<'a>) -> Self {
        Self::with(coarse_steps, length, Values::Path(values))
    }

    /// The same with `values` that fills as many rows.
    pub fn of_rows(coarse_steps: u64, length: usize, values: &'a FinalRows<'a>) -> Self {
        Self::with(coarse_steps, length, Values::Block(values, vec![[0.0; WIDTH]; length]))
    }

    fn with(last_time: u64, length: usize, values: Values<'a>) -> Self {
        let (moments, numbers) = (CrossMoments::new(length), vec![0.0; length]);
        Self { moments, last_time, values, numbers }
    }
}

impl Statistic for FinalMoments<'_> {
    fn observe(&mut self, view: &View<'_>) {
        if view.time < self.last_time {
            return;
        }
        if let Values::Block(values, rows) = &mut self.values {
            values(view, rows);
        }
        for p in view.live.paths() {
            match &self.values {
                Values::Path(values) => values(view, p, &mut self.numbers),
                Values::Block(_, rows) => {
                    self.numbers.iter_mut().zip(rows).for_each(|(number, row)| *number = row[p]);
                }
            }
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
