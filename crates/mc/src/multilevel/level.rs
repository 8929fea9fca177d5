//! The samples of one level.

use real::{PathMask, Row, WIDTH};
use serde::{Deserialize, Serialize};
use stats::CentralMoments;

use super::{
    resolution::{FunctionMotion, Motion, compares_at},
    settings::Coupling,
    tails::Extremes,
};
use crate::{Kept, Observe, PathFailure, Statistic, View};

/// Moments of one test function on one level.
#[derive(Clone, Default, Serialize, Deserialize)]
pub struct Values {
    /// φ of single paths, or the difference.
    pub sample: CentralMoments,
    /// φ on the fine path, or its average over the fine and the swapped path.
    pub fine: CentralMoments,
    /// φ on the coarse path.
    pub coarse: CentralMoments,
    /// The extreme φ on the fine path.
    pub extremes: Extremes,
    /// How φ moves along fine and coarse paths.
    pub motion: FunctionMotion,
}

impl Values {
    /// φ at the final time on these paths of a block, and φ of the coarse paths if there are some.
    fn add(&mut self, fine: &Row, coarse: Option<&Row>, paths: PathMask) {
        let of = |values: &Row| CentralMoments::of_block(values, paths);
        let of_fine = of(fine);
        self.fine.merge(&of_fine);
        self.extremes.add(fine, paths);
        match coarse {
            None => self.sample.merge(&of_fine),
            Some(coarse) => {
                self.coarse.merge(&of(coarse));
                let mut difference = *fine;
                difference.iter_mut().zip(coarse).for_each(|(fine, coarse)| *fine -= coarse);
                self.sample.merge(&of(&difference));
            }
        }
    }

    pub fn merge(&mut self, later: &Self) {
        self.sample.merge(&later.sample);
        self.fine.merge(&later.fine);
        self.coarse.merge(&later.coarse);
        self.extremes.merge(&later.extremes);
        self.motion.merge(&later.motion);
    }

    /// The least and the largest φ, or average of the fine and the swapped path.
    pub fn range(&self) -> Option<(f64, f64)> {
        hull(self.fine.range(), self.coarse.range())
    }

    /// Their distance: zero if φ is the same to the bit on every path.
    pub fn spread(&self) -> f64 {
        self.range().map_or(0.0, |(least, largest)| largest - least)
    }

    /// Whether φ is the same to the bit on every fine path, and on every coarse path.
    pub fn is_blind(&self) -> bool {
        let same = |moments: &CentralMoments| moments.range().is_none_or(|(a, b)| a == b);
        same(&self.fine) && same(&self.coarse)
    }

    /// Whether the samples vary by more than round-off.
    pub fn varies(&self) -> bool {
        self.sample.is_spread(self.fine.mean().abs() + self.fine.variance().sqrt())
    }
}

/// The least interval that contains both.
pub fn hull(a: Option<(f64, f64)>, b: Option<(f64, f64)>) -> Option<(f64, f64)> {
    match (a, b) {
        (Some(a), Some(b)) => Some((a.0.min(b.0), a.1.max(b.1))),
        (one, other) => one.or(other),
    }
}

/// The samples of one level so far.
pub struct Samples {
    pub level: usize,
    /// `None` for single paths.
    pub coupling: Option<Coupling>,
    /// Path-steps of one sample.
    pub cost_per_path: u64,
    /// One for each test function.
    pub values: Vec<Values>,
    /// Of fine and coarse paths.
    pub motion: Motion,
    /// Paths drawn, failed ones included.
    pub paths: u64,
    pub failed: u64,
}

impl Samples {
    /// Paths that count.
    pub fn count(&self) -> u64 {
        self.paths - self.failed
    }
}

/// Folds the values of all test functions at the final time, and the motion. The runs of a
/// difference are fine, coarse, a second fine one and a second coarse one, as many as there are;
/// those of single paths are one or two. Of two the mean of φ counts.
#[derive(Clone)]
pub struct PathValues<'a> {
    pub observables: &'a [&'a dyn Observe],
    pub y0: &'a [f64],
    /// φ(y₀) of each observable.
    pub starts: &'a [f64],
    pub last_time: u64,
    /// Whether there are coarse paths.
    pub coupled: bool,
    pub sums: Sums,
}

/// What a level folds over its paths.
#[derive(Clone, Serialize, Deserialize)]
pub struct Sums {
    pub values: Vec<Values>,
    pub motion: Motion,
}

impl Statistic for PathValues<'_> {
    fn observe(&mut self, view: &View<'_>) {
        let (coupled, last) = (self.coupled, view.time == self.last_time);
        if coupled {
            self.sums.motion.add(view, self.y0);
        }
        let compared = coupled && compares_at(view.time, self.last_time, view.first_path);
        if !last && !compared {
            return;
        }
        let observables = self.observables.iter().zip(self.starts);
        for ((observable, &start), values) in observables.zip(&mut self.sums.values) {
            let mut phi = [[0.0; WIDTH]; 4];
            for (run, phi) in phi.iter_mut().enumerate().take(view.runs()) {
                observable.evaluate(view.state(run), view.live, phi);
            }
            let present =
                |run: usize, else_run: usize| if run < view.runs() { run } else { else_run };
            let second = if coupled { present(2, 0) } else { present(1, 0) };
            let other = present(3, 1);
            let mean = |a: &Row, b: &Row| std::array::from_fn(|p| 0.5 * (a[p] + b[p]));
            let fine = mean(&phi[0], &phi[second]);
            let coarse = coupled.then(|| mean(&phi[1], &phi[other]));
            if let Some(coarse) = &coarse {
                view.live.paths().for_each(|p| values.motion.add(start, fine[p], coarse[p]));
            }
            if last {
                values.add(&fine, coarse.as_ref(), view.live);
            }
        }
    }

    fn merge(&mut self, later: Self) {
        let (sums, later) = (&mut self.sums, &later.sums);
        sums.values.iter_mut().zip(&later.values).for_each(|(sum, more)| sum.merge(more));
        sums.motion.merge(&later.motion);
    }
}

impl Kept for PathValues<'_> {
    type Sums = Sums;
    fn sums(&self) -> &Sums {
        &self.sums
    }
    fn sums_mut(&mut self) -> &mut Sums {
        &mut self.sums
    }
}

/// All samples of a level.
pub struct Drawn {
    pub sums: Sums,
    pub failed: u64,
    pub first_failure: Option<PathFailure>,
}
