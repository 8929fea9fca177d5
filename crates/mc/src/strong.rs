//! Mean-square errors.

use real::Row;
use stats::{CrossMoments, Moments};

use crate::{Statistic, View};

/// Mean squares for the runs of several series at the final time, and at one more time for each
/// series if it is wanted, with the covariances between the runs of a series: of the errors |y −
/// y_ref|, and of the differences of each run from the next.
///
/// The time at which an error is largest is found by a [`WorstTimes`] on other paths: then it does
/// not depend on the errors that are measured there, and moments are kept for two times and not for
/// all.
#[derive(Clone)]
pub struct StrongErrors<'a> {
    reference: Reference<'a>,
    series: Vec<Vec<usize>>,
    /// One more time for each series, or none.
    times: Vec<u64>,
    last_time: u64,
    at_end: Vec<Squares>,
    at_time: Vec<Squares>,
    /// For each run of each series, the squares at the final time on paths with clipped increments,
    /// and zero on other paths.
    clipped: Vec<Vec<Moments>>,
}

/// Moments of the squares of one series at one time.
#[derive(Clone, Debug, PartialEq)]
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

    fn add(&mut self, squares: &[f64], differences: &[f64]) {
        self.errors.add(squares);
        self.differences.add(differences);
    }

    fn merge(&mut self, later: &Self) {
        self.errors.merge(&later.errors);
        self.differences.merge(&later.differences);
    }
}

/// The reference solution y_ref of errors.
#[derive(Clone, Copy)]
pub enum Reference<'a> {
    /// A run of the same ladder.
    Run(usize),
    /// The exact solution at the final time, as a function of the random time of the ladder
    /// ([`TimeChange`](crate::TimeChange)). It is known at the final time only.
    Exact(&'a (dyn Fn(f64) -> Vec<f64> + Sync)),
}

impl<'a> StrongErrors<'a> {
    /// Errors against `reference` at the final time. `series[s]` lists the runs of series s, and
    /// `coarse_steps` is [`Ladder::coarse_steps`](crate::Ladder::coarse_steps).
    pub fn new(reference: Reference<'a>, series: &[Vec<usize>], coarse_steps: u64) -> Self {
        let at_end = series.iter().map(|runs| Squares::new(runs.len())).collect();
        let clipped = series.iter().map(|runs| vec![Moments::default(); runs.len()]).collect();
        Self {
            reference,
            series: series.to_vec(),
            times: Vec::new(),
            last_time: coarse_steps,
            at_end,
            at_time: Vec::new(),
            clipped,
        }
    }

    /// The same, and errors at coarse time `times[s]` for series s.
    ///
    /// # Panics
    /// Unless there is a time for each series, and the reference is a run.
    #[must_use]
    pub fn and_at(mut self, times: &[u64]) -> Self {
        assert_eq!(times.len(), self.series.len(), "each series has a time of its own");
        assert!(matches!(self.reference, Reference::Run(_)), "only a run is known at all times");
        self.times = times.to_vec();
        self.at_time = self.series.iter().map(|runs| Squares::new(runs.len())).collect();
        self
    }

    /// The squares at T for the runs of series s.
    pub fn at_end(&self, s: usize) -> &Squares {
        &self.at_end[s]
    }

    /// The squares for the runs of series s at the time that [`and_at`](Self::and_at) was given.
    ///
    /// # Panics
    /// If it was given none.
    pub fn at_time(&self, s: usize) -> &Squares {
        &self.at_time[s]
    }

    /// The fraction of the mean-square error at T of run r of series s that is due to paths with
    /// clipped increments.
    pub fn clipped_share(&self, s: usize, r: usize) -> f64 {
        let mean = self.at_end(s).errors.mean(r);
        if mean > 0.0 { self.clipped[s][r].mean() / mean } else { 0.0 }
    }
}

impl Statistic for StrongErrors<'_> {
    fn observe(&mut self, view: &View<'_>) {
        let at_end = view.time == self.last_time;
        if !at_end && !self.times.contains(&view.time) {
            return;
        }
        for p in view.live.paths() {
            let exact: Vec<f64> = match self.reference {
                Reference::Run(run) => view.state(run).iter().map(|row| row[p]).collect(),
                Reference::Exact(solution) => solution(view.random_time[p]),
            };
            for (s, runs) in self.series.iter().enumerate() {
                let at_time = self.times.get(s) == Some(&view.time);
                if !at_end && !at_time {
                    continue;
                }
                let error = |&run: &usize| {
                    let pairs = view.state(run).iter().zip(&exact);
                    pairs.map(|(y, x)| (y[p] - x) * (y[p] - x)).sum()
                };
                let squares: Vec<f64> = runs.iter().map(error).collect();
                let differences: Vec<f64> = runs
                    .windows(2)
                    .map(|pair| squared_difference(view.state(pair[0]), view.state(pair[1]), p))
                    .collect();
                if at_time {
                    self.at_time[s].add(&squares, &differences);
                }
                if at_end {
                    self.at_end[s].add(&squares, &differences);
                    for (r, &run) in runs.iter().enumerate() {
                        let clipped = if view.clipped[run].contains(p) { squares[r] } else { 0.0 };
                        self.clipped[s][r].add(clipped);
                    }
                }
            }
        }
    }

    fn merge(&mut self, later: Self) {
        let clipped = later.clipped.into_iter().flatten();
        self.clipped.iter_mut().flatten().zip(clipped).for_each(|(sum, more)| sum.merge(more));
        self.at_end.iter_mut().zip(&later.at_end).for_each(|(sum, more)| sum.merge(more));
        self.at_time.iter_mut().zip(&later.at_time).for_each(|(sum, more)| sum.merge(more));
    }
}

/// The coarse time at which the mean square of the difference of two runs is largest, for several
/// pairs of runs.
///
/// To leading order the errors of two step sizes have the same course in time, and so has their
/// difference: two coarse runs on some hundred paths find the time at which the error of the
/// coarser one is largest, at no cost beside that of a reference.
#[derive(Clone, Debug)]
pub struct WorstTimes {
    pairs: Vec<[usize; 2]>,
    /// For each pair the sums of squares at all coarse times.
    squares: Vec<Vec<f64>>,
}

impl WorstTimes {
    /// Of these pairs of runs of a ladder with so many coarse steps.
    pub fn new(pairs: Vec<[usize; 2]>, coarse_steps: u64) -> Self {
        let squares = vec![vec![0.0; coarse_steps as usize]; pairs.len()];
        Self { pairs, squares }
    }

    /// The times by pair, counted in coarse steps from 1.
    pub fn times(&self) -> Vec<u64> {
        let worst = |squares: &Vec<f64>| {
            (1..).zip(squares).max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(time, _)| time)
        };
        self.squares.iter().map(worst).collect()
    }
}

impl Statistic for WorstTimes {
    fn observe(&mut self, view: &View<'_>) {
        for (squares, pair) in self.squares.iter_mut().zip(&self.pairs) {
            let [one, other] = pair.map(|run| view.state(run));
            let square = |p: usize| squared_difference(one, other, p);
            squares[view.time as usize - 1] += view.live.paths().map(square).sum::<f64>();
        }
    }

    fn merge(&mut self, later: Self) {
        let later = later.squares.into_iter().flatten();
        self.squares.iter_mut().flatten().zip(later).for_each(|(sum, more)| *sum += more);
    }
}

/// |y − x|² on path p.
fn squared_difference(y: &[Row], x: &[Row], p: usize) -> f64 {
    y.iter().zip(x).map(|(y, x)| (y[p] - x[p]) * (y[p] - x[p])).sum()
}

/// |y − x|².
pub fn squared_distance<const D: usize>(y: [f64; D], x: [f64; D]) -> f64 {
    (0..D).map(|i| (y[i] - x[i]) * (y[i] - x[i])).sum()
}
