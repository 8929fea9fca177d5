//! Differences of expectations between successive levels.

use stats::CrossMoments;

use crate::{Statistic, View};

/// A test function φ with its name.
#[derive(Clone, Copy, Debug)]
pub struct Observable<const D: usize> {
    /// Its name in results, for example `y1` or `cos y3`.
    pub name: &'static str,
    /// φ(y).
    pub function: fn([f64; D]) -> f64,
}

/// Differences of expectations between successive levels at the final time, for several test
/// functions φ, with covariances between the levels.
///
/// E[φ(y_τ)] − E[φ(y_{τ/2})] is the mean of φ(coarse) − ½(φ(fine) + φ(swapped)). The swapped run
/// exchanges the two increments of every coarse step. This antithetic path cancels the Lévy areas
/// that schemes of strong order ½ omit. The variance of the difference is of order τ², while that
/// of φ(coarse) − φ(fine) is of order τ (Giles and Szpruch 2014, *Ann. Appl. Probab.* 24).
#[derive(Clone, Debug)]
pub struct WeakDifferences<const D: usize> {
    observables: Vec<Observable<D>>,
    /// The runs (coarse, fine, swapped) of each difference.
    runs: Vec<(usize, usize, usize)>,
    last_time: u64,
    moments: Vec<CrossMoments>,
}

impl<const D: usize> WeakDifferences<D> {
    /// Differences for the given test functions. `runs[l]` are the runs (coarse, fine, swapped) of
    /// difference number l, and `coarse_steps` is
    /// [`Ladder::coarse_steps`](crate::Ladder::coarse_steps).
    pub fn new(
        observables: &[Observable<D>],
        runs: &[(usize, usize, usize)],
        coarse_steps: u64,
    ) -> Self {
        Self {
            observables: observables.to_vec(),
            runs: runs.to_vec(),
            last_time: coarse_steps,
            moments: vec![CrossMoments::new(runs.len()); observables.len()],
        }
    }

    /// The moments of the differences for test function number f.
    pub fn moments(&self, f: usize) -> &CrossMoments {
        &self.moments[f]
    }
}

impl<const D: usize> Statistic<D> for WeakDifferences<D> {
    fn observe(&mut self, view: &View<'_, D>) {
        if view.time != self.last_time {
            return;
        }
        let mut differences = vec![0.0; self.runs.len()];
        for (observable, moments) in self.observables.iter().zip(&mut self.moments) {
            let phi = |run: usize, p: usize| (observable.function)(view.states[run].path(p));
            for p in view.live.paths() {
                for (value, &(coarse, fine, swapped)) in differences.iter_mut().zip(&self.runs) {
                    *value = phi(coarse, p) - 0.5 * (phi(fine, p) + phi(swapped, p));
                }
                moments.add(&differences);
            }
        }
    }

    fn merge(&mut self, later: Self) {
        for (sum, more) in self.moments.iter_mut().zip(&later.moments) {
            sum.merge(more);
        }
    }
}
