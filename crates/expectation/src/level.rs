//! The samples of one level, by replicates and all together.

use noise::ScrambledSobol;
use real::{PathMask, Row};
use serde::{Deserialize, Serialize};
use stats::{CentralMoments, FEW_SAMPLES, Tail};

use super::resolution::{Motion, PARTS, compares_at, part};
use mc::{GROUP_PATHS, Measured, Observe, Statistic, View};

/// Moments of one test function on one level.
#[derive(Clone, Default, Serialize, Deserialize)]
pub struct Values {
    /// Moments of φ on single paths, or of the difference.
    pub sample: CentralMoments,
    /// Moments of φ on the fine path, or of its average over two fine paths.
    pub fine: CentralMoments,
    /// Moments of φ on the coarse path, or of its average over two.
    pub coarse: CentralMoments,
    /// Values of φ on the fine paths of the pilot. They show the tail of its law before rounds go
    /// on until samples look light.
    pub pilot: Vec<f64>,
}

impl Values {
    /// Adds φ at the final time on `paths` of a block, and φ on the coarse paths if there are some.
    fn add(&mut self, fine: &Row, coarse: Option<&Row>, paths: PathMask) {
        let of = |values: &Row| CentralMoments::of_block(values, paths);
        let mut sample = of(fine);
        self.fine.merge(&sample);
        if let Some(coarse) = coarse {
            self.coarse.merge(&of(coarse));
            sample = of(&std::array::from_fn(|p| fine[p] - coarse[p]));
        }
        self.sample.merge(&sample);
    }

    pub fn merge(&mut self, later: &Self) {
        self.sample.merge(&later.sample);
        self.fine.merge(&later.fine);
        self.coarse.merge(&later.coarse);
        self.pilot.extend(&later.pilot);
    }

    /// The least and the largest φ on fine and coarse paths.
    pub fn range(&self) -> Option<(f64, f64)> {
        hull([&self.fine, &self.coarse].into_iter().filter_map(CentralMoments::range))
    }

    /// Distance from the least to the largest φ: zero if φ is the same to the bit on every path.
    pub fn spread(&self) -> f64 {
        self.range().map_or(0.0, |(least, largest)| largest - least)
    }

    /// Whether φ is the same to the bit on every fine path, and on every coarse path.
    pub fn is_blind(&self) -> bool {
        let same = |moments: &CentralMoments| moments.range().is_none_or(|(a, b)| a == b);
        same(&self.fine) && same(&self.coarse)
    }

    /// Whether fewer than thirty fine paths carry the variance of φ and the events are not of one
    /// size: larger ones may be missing, whose size is not known.
    pub fn is_heavy(&self) -> bool {
        self.fine.effective_samples() < FEW_SAMPLES && !self.fine.is_two_valued()
    }

    /// Whether the samples vary by more than round-off.
    pub fn varies(&self) -> bool {
        self.sample.is_spread(self.fine.mean().abs() + self.fine.variance().sqrt())
    }
}

/// The smallest interval that contains all.
pub fn hull(ranges: impl Iterator<Item = (f64, f64)>) -> Option<(f64, f64)> {
    ranges.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}

/// The tail of test function number k on the last of these levels, which is nearest to the
/// solution: on coarse levels increments are clipped, and states that steps do not resolve grow
/// large.
pub fn tail(levels: &[Samples], k: usize) -> Tail {
    let Values { fine, pilot, .. } = &levels[levels.len() - 1].values[k];
    fine.tail(pilot)
}

/// The samples of one level so far.
#[derive(Default)]
pub struct Samples {
    /// Number of the level; samples are φ on level 0 and differences on others.
    pub level: usize,
    /// Path-steps of one sample.
    pub cost_per_path: u64,
    /// Points of each replicate, failed ones included.
    pub points: u64,
    /// Paths of all replicates, failed ones included.
    pub paths: u64,
    pub failed: u64,
    /// Moments over all replicates together, for each test function.
    pub values: Vec<Values>,
    /// Motion of fine and coarse paths, up to T, T/8 and T/64.
    pub motion: [Motion; PARTS],
    /// The motion of each test function.
    pub functions: Motion,
    /// Moments over replicates, for each test function: of the difference, and of φ on the fine
    /// path.
    pub means: Vec<[Means; 2]>,
}

/// Moments over the replicates.
#[derive(Clone, Copy, Default)]
pub struct Means {
    /// Moments of the mean over the points of a replicate.
    pub mean: CentralMoments,
    /// Moments of the largest and the least value of a replicate.
    ends: [CentralMoments; 2],
}

impl Means {
    fn add(&mut self, points: &CentralMoments) {
        self.mean.add(points.mean());
        if let Some((least, largest)) = points.range() {
            self.ends[0].add(largest);
            self.ends[1].add(least);
        }
    }

    /// The variance that the largest and the least of `points` points give to the mean of a
    /// replicate.
    pub fn variance_of_ends(&self, points: u64) -> f64 {
        let n = points as f64;
        self.ends.iter().map(CentralMoments::variance).sum::<f64>() / (n * n)
    }
}

impl Samples {
    /// The share of the paths that failed.
    pub fn lost(&self) -> f64 {
        self.failed as f64 / self.paths as f64
    }

    /// Number of paths that have not failed.
    pub fn count(&self) -> u64 {
        self.paths - self.failed
    }

    /// Takes all samples of every replicate, each with `points` points.
    pub fn take(&mut self, replicates: Vec<Measured<PathValues<'_>>>, points: u64) {
        let functions = replicates.first().map_or(0, |one| one.statistic.values.len());
        *self = Self {
            level: self.level,
            cost_per_path: self.cost_per_path,
            points,
            paths: points * replicates.len() as u64,
            values: vec![Values::default(); functions],
            means: vec![Default::default(); functions],
            ..Self::default()
        };
        for Measured { statistic: own, failed, .. } in replicates {
            for ((all, means), own) in self.values.iter_mut().zip(&mut self.means).zip(&own.values)
            {
                means[0].add(&own.sample);
                means[1].add(&own.fine);
                all.merge(own);
            }
            for (n, part) in own.motion.iter().enumerate() {
                self.motion[..=n].iter_mut().for_each(|motion| motion.merge(part));
            }
            self.functions.merge(&own.functions);
            self.failed += failed;
        }
    }
}

/// Folds the values of all test functions at the final time, and the motion. The runs of a
/// difference are fine, coarse, a second fine one and a second coarse one, if there are such; those
/// of single paths are one or two. Of two the mean of φ counts.
#[derive(Clone, Serialize, Deserialize)]
pub struct PathValues<'a> {
    #[serde(skip)]
    pub observables: &'a [&'a dyn Observe],
    pub last_time: u64,
    /// Whether there are coarse paths.
    pub coupled: bool,
    pub values: Vec<Values>,
    /// Motion of the states in each part of the time, and of each test function.
    pub motion: [Motion; PARTS],
    pub functions: Motion,
}

impl Statistic for PathValues<'_> {
    fn observe(&mut self, view: &View<'_>) {
        let (coupled, last) = (self.coupled, view.time == self.last_time);
        if coupled {
            self.motion[part(view.time, self.last_time)].add(view);
        }
        let compared = coupled && compares_at(view.time, self.last_time, view.first_path);
        if !last && !compared {
            return;
        }
        let mut functions = Vec::new();
        for (observable, values) in self.observables.iter().zip(&mut self.values) {
            let of_run = |run| observable.values(view.state(run), view.live);
            let phi: Vec<Row> = (0..view.runs()).map(of_run).collect();
            // The mean over a run and its second one, if there is one.
            let mean = |run: usize, second: usize| {
                let (a, b) = (&phi[run], phi.get(second).unwrap_or(&phi[run]));
                std::array::from_fn(|p| 0.5 * (a[p] + b[p]))
            };
            let fine = mean(0, if coupled { 2 } else { 1 });
            let coarse = coupled.then(|| mean(1, 3));
            functions.extend(coarse.map(|coarse| [fine, coarse]));
            if last {
                values.add(&fine, coarse.as_ref(), view.live);
                if view.first_path % ScrambledSobol::POINTS < GROUP_PATHS {
                    values.pilot.extend(view.live.paths().map(|p| fine[p]));
                }
            }
        }
        if coupled {
            let rows = functions.iter().map(|[fine, coarse]| [fine, fine, coarse, coarse]);
            self.functions.add_rows(view.live, rows);
        }
    }

    fn merge(&mut self, later: Self) {
        self.values.iter_mut().zip(&later.values).for_each(|(sum, more)| sum.merge(more));
        self.motion.iter_mut().zip(&later.motion).for_each(|(sum, more)| sum.merge(more));
        self.functions.merge(&later.functions);
    }
}
