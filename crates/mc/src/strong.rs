//! Mean-square errors.

use stats::{CrossMoments, Moments};

use crate::{Statistic, View};

/// The mean squares of |y − y_ref| for the runs of several series at every coarse time, with the
/// covariances of the squares between the runs of a series.
#[derive(Clone)]
pub struct StrongErrors<'a, const D: usize> {
    reference: Reference<'a, D>,
    series: Vec<Vec<usize>>,
    /// For each series one entry per coarse time; the last is the final time.
    in_time: Vec<Vec<CrossMoments>>,
    /// For each run of each series, the squares at the final time on paths with clipped increments,
    /// and zero on other paths.
    clipped: Vec<Vec<Moments>>,
    last_time: u64,
}

/// The reference solution y_ref of errors.
#[derive(Clone, Copy)]
pub enum Reference<'a, const D: usize> {
    /// A run of the same ladder.
    Run(usize),
    /// The exact solution at the final time, as a function of the random time of the ladder
    /// ([`TimeChange`](crate::TimeChange)). Errors are then measured at the final time only.
    Exact(&'a (dyn Fn(f64) -> [f64; D] + Sync)),
}

impl<'a, const D: usize> StrongErrors<'a, D> {
    /// Errors against `reference`. `series[s]` lists the runs of series s, and `coarse_steps` is
    /// [`Ladder::coarse_steps`](crate::Ladder::coarse_steps).
    pub fn new(reference: Reference<'a, D>, series: &[Vec<usize>], coarse_steps: u64) -> Self {
        Self {
            reference,
            series: series.to_vec(),
            in_time: series
                .iter()
                .map(|runs| vec![CrossMoments::new(runs.len()); coarse_steps as usize])
                .collect(),
            clipped: series.iter().map(|runs| vec![Moments::default(); runs.len()]).collect(),
            last_time: coarse_steps,
        }
    }

    /// The moments of |y(T) − y_ref(T)|² for the runs of series s.
    pub fn at_end(&self, s: usize) -> &CrossMoments {
        let times = &self.in_time[s];
        &times[times.len() - 1]
    }

    /// The fraction of the mean-square error at T of run r of series s that is due to paths with
    /// clipped increments.
    pub fn clipped_share(&self, s: usize, r: usize) -> f64 {
        let mean = self.at_end(s).mean(r);
        if mean > 0.0 { self.clipped[s][r].mean() / mean } else { 0.0 }
    }

    /// The moments for the runs of series s at the coarse time where the mean-square error of the
    /// first run is largest.
    pub fn at_worst_time(&self, s: usize) -> &CrossMoments {
        let larger = |a: &&CrossMoments, b: &&CrossMoments| a.mean(0).total_cmp(&b.mean(0));
        self.in_time[s].iter().max_by(larger).unwrap_or(self.at_end(s))
    }
}

impl<const D: usize> Statistic<D> for StrongErrors<'_, D> {
    fn observe(&mut self, view: &View<'_, D>) {
        let at_end = view.time == self.last_time;
        let only_at_end = matches!(self.reference, Reference::Exact(_));
        if only_at_end && !at_end {
            return;
        }
        for p in view.live.paths() {
            let exact = match self.reference {
                Reference::Run(run) => view.states[run].path(p),
                Reference::Exact(solution) => solution(view.random_time.0[0][p]),
            };
            for (s, runs) in self.series.iter().enumerate() {
                let square = |&run: &usize| {
                    let y = view.states[run].path(p);
                    (0..D).map(|i| (y[i] - exact[i]) * (y[i] - exact[i])).sum()
                };
                let squares: Vec<f64> = runs.iter().map(square).collect();
                self.in_time[s][view.time as usize - 1].add(&squares);
                if at_end {
                    for (r, &run) in runs.iter().enumerate() {
                        let clipped = if view.clipped[run].contains(p) { squares[r] } else { 0.0 };
                        self.clipped[s][r].add(clipped);
                    }
                }
            }
        }
    }

    fn merge(&mut self, later: Self) {
        for (sum, more) in
            self.clipped.iter_mut().flatten().zip(later.clipped.into_iter().flatten())
        {
            sum.merge(more);
        }
        for (sum, more) in self.in_time.iter_mut().flatten().zip(later.in_time.iter().flatten()) {
            sum.merge(more);
        }
    }
}
