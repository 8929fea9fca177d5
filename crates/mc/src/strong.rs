//! Mean-square errors against a reference run on the same noise.

use real::{Block, PathMask};

use crate::{CrossMoments, Moments, Statistic};

/// |y − y_ref|² of every run of every series: with covariances between the runs of a series at the final time, and
/// alone at every coarse time, for the supremum over time.
#[derive(Clone, Debug)]
pub struct StrongErrors {
    reference: usize,
    series: Vec<Vec<usize>>,
    at_end: Vec<CrossMoments>,
    /// For each series and run of it, one entry a coarse time.
    in_time: Vec<Vec<Vec<Moments>>>,
    last_time: u64,
}

impl StrongErrors {
    /// Errors against run number `reference`; `series[s]` lists the runs of series s.
    #[must_use]
    pub fn new(reference: usize, series: &[Vec<usize>], coarse_steps: u64) -> Self {
        let times = vec![Moments::default(); coarse_steps as usize];
        Self {
            reference,
            series: series.to_vec(),
            at_end: series.iter().map(|runs| CrossMoments::new(runs.len())).collect(),
            in_time: series.iter().map(|runs| vec![times.clone(); runs.len()]).collect(),
            last_time: coarse_steps,
        }
    }

    /// |y(T) − y_ref(T)|² of the runs of series s.
    #[must_use]
    pub fn at_end(&self, s: usize) -> &CrossMoments {
        &self.at_end[s]
    }

    /// The coarse time with the largest mean-square error of run r of series s.
    #[must_use]
    pub fn worst_time(&self, s: usize, r: usize) -> Moments {
        let larger = |a: Moments, b: Moments| if b.mean() > a.mean() { b } else { a };
        self.in_time[s][r].iter().copied().reduce(larger).unwrap_or_default()
    }
}

impl<const D: usize> Statistic<D> for StrongErrors {
    fn observe(&mut self, time: u64, states: &[Block<D>], live: PathMask) {
        let reference = &states[self.reference];
        for (s, runs) in self.series.iter().enumerate() {
            let mut squares = vec![0.0; runs.len()];
            for p in live.paths() {
                let exact = reference.path(p);
                for (r, &run) in runs.iter().enumerate() {
                    let y = states[run].path(p);
                    squares[r] = (0..D).map(|i| (y[i] - exact[i]) * (y[i] - exact[i])).sum();
                    self.in_time[s][r][time as usize - 1].add(squares[r]);
                }
                if time == self.last_time {
                    self.at_end[s].add(&squares);
                }
            }
        }
    }

    fn merge(&mut self, later: Self) {
        for (sum, more) in self.at_end.iter_mut().zip(&later.at_end) {
            sum.merge(more);
        }
        let sums = self.in_time.iter_mut().flatten().flatten();
        for (sum, more) in sums.zip(later.in_time.into_iter().flatten().flatten()) {
            sum.merge(more);
        }
    }
}
