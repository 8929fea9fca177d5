//! The largest and the smallest samples, and how fast their deviations become rare.

use real::{PathMask, Real, Row, WIDTH};

/// How many of the largest and of the smallest samples are kept.
const KEPT: usize = 65;

/// The largest samples.
#[derive(Clone, Default)]
struct Largest {
    samples: Vec<f64>,
    /// No sample up to this one counts any more.
    passed: Option<f64>,
}

impl Largest {
    /// Keeps those that count, if there are many.
    fn extend(&mut self, samples: impl Iterator<Item = f64>) {
        if self.samples.is_empty() {
            self.samples.reserve(4 * WIDTH);
        }
        let passed = self.passed.unwrap_or(f64::NEG_INFINITY);
        self.samples.extend(samples.filter(|&x| x > passed));
        if self.samples.len() > 4 * KEPT {
            self.samples.select_nth_unstable_by(KEPT - 1, |a, b| b.total_cmp(a));
            self.samples.truncate(KEPT);
            self.passed = Some(self.samples[KEPT - 1]);
        }
    }

    fn merge(&mut self, later: &Self) {
        self.passed = self.passed.into_iter().chain(later.passed).reduce(f64::max);
        self.extend(later.samples.iter().copied());
    }
}

/// The largest samples, and the negatives of the smallest.
#[derive(Clone, Default)]
pub struct Extremes {
    largest: Largest,
    smallest: Largest,
}

impl Extremes {
    /// Adds these paths of a block.
    pub fn add(&mut self, x: &Row, paths: PathMask) {
        self.largest.extend(paths.paths().map(|p| x[p]));
        self.smallest.extend(paths.paths().map(|p| -x[p]));
    }

    pub fn merge(&mut self, later: &Self) {
        self.largest.merge(&later.largest);
        self.smallest.merge(&later.smallest);
    }

    /// The largest distances from the mean, the largest first.
    fn deviations(&self, mean: f64) -> Vec<f64> {
        let above = self.largest.samples.iter().map(|x| x - mean);
        let below = self.smallest.samples.iter().map(|x| mean + x);
        let mut deviations: Vec<f64> = above.chain(below).filter(|&x| x > 0.0).collect();
        deviations.sort_unstable_by(|a, b| b.total_cmp(a));
        deviations.truncate(KEPT);
        deviations
    }

    /// Hill's estimate of the exponent α in P(|φ − Eφ| > x) ∝ x^{−α} from the largest sixteenth of
    /// the deviations of n samples with this mean, 64 at most (Hill, *Ann. Statist.* 3, 1975);
    /// infinite if they are of one size. With α ≤ 2 there is no variance, and where a sample shows
    /// α ≤ 2, as that of e^{3W} does, its variance is far below the true one.
    pub fn tail_index(&self, n: u64, mean: f64) -> f64 {
        let deviations = self.deviations(mean);
        let number = (n / 16).min(deviations.len().saturating_sub(1) as u64) as usize;
        let logarithm = |x: f64| Real::ln(x / deviations[number]);
        let sum: f64 = deviations[..number].iter().map(|&x| logarithm(x)).sum();
        if sum > 0.0 { number as f64 / sum } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONE: PathMask = PathMask(1);

    #[test]
    fn the_tail_index_of_powers() {
        // u^{−1/α} at the middles of n intervals, and their negatives, shifted: deviations fall
        // like x^{−α}. Hill's estimate from 64 of them scatters by an eighth; from the middles it
        // does not.
        for (alpha, n) in [(1.0, 4000), (3.0, 4000), (3.0, 100_000)] {
            let mut extremes = Extremes::default();
            for i in 0..n {
                let u: f64 = (f64::from(i) + 0.5) / f64::from(n);
                for sign in [1.0, -1.0] {
                    extremes.add(&[100.0 + sign * u.powf(-1.0 / alpha); WIDTH], ONE);
                }
            }
            let found = extremes.tail_index(2 * n as u64, 100.0);
            assert!((found / alpha - 1.0).abs() < 0.1, "{alpha} {n}: {found}");
        }
    }

    #[test]
    fn merged_extremes_are_those_of_all_samples() {
        let samples: Vec<f64> = (0..1000).map(|n| f64::from(n * 617 % 1000)).collect();
        let mut all = Extremes::default();
        for part in samples.chunks(170) {
            let mut extremes = Extremes::default();
            part.iter().for_each(|&x| extremes.add(&[x; WIDTH], ONE));
            all.merge(&extremes);
        }
        assert_eq!(all.deviations(700.0)[..5], [700.0, 699.0, 698.0, 697.0, 696.0]);
        assert_eq!(all.deviations(-1000.0)[0], 1999.0);
        let both = all.deviations(499.5);
        assert_eq!(both[..4], [499.5, 499.5, 498.5, 498.5]);
        assert_eq!(both.len(), KEPT);
    }
}
