//! The small statistic of all measurements.

use mc::{Statistic, View};
use stats::Moments;

/// The mean of every component at the last of `coarse_steps` coarse steps, of the first run.
pub(crate) struct LastMean<const D: usize> {
    coarse_steps: u64,
    means: [Moments; D],
}

impl<const D: usize> LastMean<D> {
    pub(crate) fn new(coarse_steps: u64) -> Self {
        Self { coarse_steps, means: [Moments::default(); D] }
    }

    /// Whether every mean is a number.
    pub(crate) fn is_finite(&self) -> bool {
        self.means.iter().all(|moments| moments.mean().is_finite())
    }
}

impl<const D: usize> Statistic<D> for LastMean<D> {
    fn observe(&mut self, view: &View<'_, D>) {
        if view.time < self.coarse_steps {
            return;
        }
        for p in view.live.paths() {
            for (moments, x) in self.means.iter_mut().zip(view.states[0].path(p)) {
                moments.add(x);
            }
        }
    }

    fn merge(&mut self, later: Self) {
        for (moments, more) in self.means.iter_mut().zip(later.means) {
            moments.merge(more);
        }
    }
}
