//! Means over the points of each scramble of a level.

use stats::CentralMoments;

use super::super::{
    level::{Drawn, Samples, Sums, Values},
    plan::Term,
    resolution::Motion,
    tails::Tail,
};

/// The scrambles of one level.
#[derive(Default)]
pub struct Scrambles {
    /// Points of each, failed ones included.
    pub points: u64,
    /// One for each test function.
    means: Vec<Means>,
}

/// One test function: numbers of each scramble, as samples.
#[derive(Clone, Copy, Default)]
struct Means {
    /// Of φ of single paths, or of the difference.
    sample: Own,
    /// Of φ on the fine path.
    fine: Own,
}

/// Numbers of each scramble.
#[derive(Clone, Copy, Default)]
pub struct Own {
    /// The mean over its points.
    pub mean: CentralMoments,
    /// Its largest and its least value.
    ends: [CentralMoments; 2],
}

impl Own {
    fn add(&mut self, points: &CentralMoments) {
        self.mean.add(points.mean());
        if let Some((least, largest)) = points.range() {
            self.ends[0].add(largest);
            self.ends[1].add(least);
        }
    }

    /// The variance that the largest and the least of so many points give to the mean of a
    /// scramble.
    pub fn variance_of_ends(&self, points: u64) -> f64 {
        let n = points as f64;
        self.ends.iter().map(CentralMoments::variance).sum::<f64>() / (n * n)
    }
}

impl Scrambles {
    /// Takes all samples of every scramble, each with so many points, and gives `samples` those of
    /// all together.
    pub fn take(&mut self, samples: &mut Samples, scrambles: Vec<Drawn>, points: u64) {
        let functions = samples.values.len();
        let (mut values, mut motion) = (vec![Values::default(); functions], Motion::default());
        self.means = vec![Means::default(); functions];
        (samples.failed, samples.paths) = (0, points * scrambles.len() as u64);
        for Drawn { sums: Sums { values: own, motion: moved }, failed, .. } in scrambles {
            for (k, own) in own.iter().enumerate() {
                self.means[k].sample.add(&own.sample);
                self.means[k].fine.add(&own.fine);
                values[k].merge(own);
            }
            motion.merge(&moved);
            samples.failed += failed;
        }
        (samples.values, samples.motion, self.points) = (values, motion, points);
    }

    /// The numbers of test function number k: of the difference, or, for the `first` term of a sum,
    /// of φ on the fine path.
    pub fn own(&self, k: usize, first: bool) -> &Own {
        if first { &self.means[k].fine } else { &self.means[k].sample }
    }

    /// Test function number k on this level as a term of a sum. Its variance is such that
    /// variance/count is that of the mean over scrambles.
    pub fn term(&self, samples: &Samples, k: usize, first: bool, tail: Tail) -> Term {
        let mean = &self.own(k, first).mean;
        let (cost, count) = (samples.cost_per_path as f64, samples.count() as f64);
        // One path without noise has no error of sampling.
        let variance = if mean.count() > 1 { count * mean.variance_of_mean() } else { 0.0 };
        Term { cost, count, mean: mean.mean(), variance, tail }
    }

    /// The variance of independent points over that of Sobol points, for the mean of φ number k on
    /// the fine path; NaN where it does not vary.
    pub fn gain(&self, samples: &Samples, k: usize) -> f64 {
        samples.values[k].fine.variance_of_mean() / self.means[k].fine.mean.variance_of_mean()
    }
}
