//! Mean-square errors.

use stats::{CrossMoments, Moments};

use crate::{Statistic, View};

/// Mean squares for the runs of several series at every coarse time, with the covariances between
/// the runs of a series: of the errors |y − y_ref|, and of the differences of each run from the
/// next.
#[derive(Clone)]
pub struct StrongErrors<'a, const D: usize> {
    reference: Reference<'a, D>,
    series: Vec<Vec<usize>>,
    /// For each series one entry per coarse time; the last is the final time.
    in_time: Vec<Vec<Squares>>,
    /// For each run of each series, the squares at the final time on paths with clipped increments,
    /// and zero on other paths.
    clipped: Vec<Vec<Moments>>,
    last_time: u64,
}

/// Moments of the squares of one series at one time.
#[derive(Clone)]
pub struct Squares {
    /// |y − y_ref|² of each run.
    pub errors: CrossMoments,
    /// |y − y′|² of each run y but the last and the next one y′.
    pub differences: CrossMoments,
}

impl Squares {
    fn new(runs: usize) -> Self {
        let [errors, differences] = [runs, runs.saturating_sub(1)].map(CrossMoments::new);
        Self { errors, differences }
    }
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
                .map(|runs| vec![Squares::new(runs.len()); coarse_steps as usize])
                .collect(),
            clipped: series.iter().map(|runs| vec![Moments::default(); runs.len()]).collect(),
            last_time: coarse_steps,
        }
    }

    /// The squares at T for the runs of series s.
    pub fn at_end(&self, s: usize) -> &Squares {
        let times = &self.in_time[s];
        &times[times.len() - 1]
    }

    /// The fraction of the mean-square error at T of run r of series s that is due to paths with
    /// clipped increments.
    pub fn clipped_share(&self, s: usize, r: usize) -> f64 {
        let mean = self.at_end(s).errors.mean(r);
        if mean > 0.0 { self.clipped[s][r].mean() / mean } else { 0.0 }
    }

    /// The squares for the runs of series s at the coarse time where the mean-square error of the
    /// first run is largest.
    pub fn at_worst_time(&self, s: usize) -> &Squares {
        let first = |squares: &&Squares| squares.errors.mean(0);
        let larger = |a: &&Squares, b: &&Squares| first(a).total_cmp(&first(b));
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
                let state = |run: usize| view.states[run].path(p);
                let squares: Vec<f64> =
                    runs.iter().map(|&run| squared_distance(state(run), exact)).collect();
                let differences: Vec<f64> = runs
                    .windows(2)
                    .map(|pair| squared_distance(state(pair[0]), state(pair[1])))
                    .collect();
                let in_time = &mut self.in_time[s][view.time as usize - 1];
                in_time.errors.add(&squares);
                in_time.differences.add(&differences);
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
            sum.errors.merge(&more.errors);
            sum.differences.merge(&more.differences);
        }
    }
}

/// |y − x|².
pub fn squared_distance<const D: usize>(y: [f64; D], x: [f64; D]) -> f64 {
    (0..D).map(|i| (y[i] - x[i]) * (y[i] - x[i])).sum()
}
