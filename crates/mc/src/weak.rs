//! Differences of expectations between neighbouring levels, with antithetic twins.
//!
//! E[φ(y_τ)] − E[φ(y_{τ/2})] is the mean of φ(coarse) − ½(φ(fine) + φ(swapped)), where the swapped
//! path takes the two increments of every coarse step in the other order. The twin cancels the Lévy
//! areas that the schemes leave out: the variance of the difference falls like τ² where that of
//! φ(coarse) − φ(fine) falls like τ (Giles and Szpruch, *Ann. Appl. Probab.* 24, 2014).

use stats::CrossMoments;

use crate::{Statistic, View};

/// A test function φ.
#[derive(Clone, Copy, Debug)]
pub struct Observable<const D: usize> {
    /// Its name in results, for example `y1` or `cos y3`.
    pub name: &'static str,
    /// φ(y).
    pub function: fn([f64; D]) -> f64,
}

/// The runs of one difference.
#[derive(Clone, Copy, Debug)]
struct Difference {
    coarse: usize,
    fine: usize,
    swapped: usize,
}

/// Differences at the final time for several test functions, with covariances between the levels.
#[derive(Clone, Debug)]
pub struct WeakDifferences<const D: usize> {
    observables: Vec<Observable<D>>,
    differences: Vec<Difference>,
    last_time: u64,
    moments: Vec<CrossMoments>,
}

impl<const D: usize> WeakDifferences<D> {
    /// `runs[l]` are the runs (coarse, fine, swapped) of difference number l.
    #[must_use]
    pub fn new(
        observables: &[Observable<D>],
        runs: &[(usize, usize, usize)],
        coarse_steps: u64,
    ) -> Self {
        Self {
            observables: observables.to_vec(),
            differences: runs
                .iter()
                .map(|&(coarse, fine, swapped)| Difference { coarse, fine, swapped })
                .collect(),
            last_time: coarse_steps,
            moments: vec![CrossMoments::new(runs.len()); observables.len()],
        }
    }

    /// The differences of test function number f.
    #[must_use]
    pub fn of(&self, f: usize) -> &CrossMoments {
        &self.moments[f]
    }
}

impl<const D: usize> Statistic<D> for WeakDifferences<D> {
    fn observe(&mut self, view: &View<'_, D>) {
        if view.time != self.last_time {
            return;
        }
        let mut differences = vec![0.0; self.differences.len()];
        for (observable, moments) in self.observables.iter().zip(&mut self.moments) {
            let phi = |run: usize, p: usize| (observable.function)(view.states[run].path(p));
            for p in view.live.paths() {
                for (value, runs) in differences.iter_mut().zip(&self.differences) {
                    *value = phi(runs.coarse, p) - 0.5 * (phi(runs.fine, p) + phi(runs.swapped, p));
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
