//! Events that the samples of a level may have missed.

use std::cmp::Ordering;

use real::{PathMask, Real, Row, WIDTH};
use serde::{Deserialize, Serialize};

use super::level::Samples;

/// No event in N samples: 97.5 % upper limit u of the expected number, −ln 0.025. With k events the
/// interval k ± √(1.96²k + u²) covers a Poisson number with 93 % or more for any mean, and events
/// of several levels with more.
pub const UNSEEN: f64 = 3.688_879_454_113_936;
/// With this many events the normal interval k ± 1.96√k covers as well without u. A variance that
/// so many samples carry is known to √(1/30) of itself, and its root to a tenth.
const EVENTS: f64 = 30.0;

/// What missed events may add to the mean of one test function on one level.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tail {
    /// Half-width times number of samples: [`UNSEEN`]·R, or zero where the samples suffice.
    pub size: f64,
    /// Number of samples that are expected to suffice.
    pub enough: f64,
}

impl Tail {
    /// The tail of n samples with this kurtosis, NaN where none differs, that may spread by
    /// `reach`. N/κ samples carry the variance: the events, if it is due to events.
    pub fn new(n: f64, kurtosis: f64, reach: f64) -> Self {
        let enough = EVENTS * if kurtosis.is_nan() { n } else { kurtosis };
        Self { size: if n < enough { UNSEEN * reach } else { 0.0 }, enough }
    }
}

/// The tail of test function number k on each of these levels, where φ spreads by `range` on all.
///
/// A single path may spread by `range`. A difference may be as large as the largest of its level
/// and of the level below, where events of the same kind are more frequent; where none differs, as
/// large as `range`. Nor is its kurtosis less than on the level below.
pub fn tails(levels: &[Samples], k: usize, range: f64) -> Vec<Tail> {
    let mut below = (f64::NAN, 0.0);
    let tail = |samples: &Samples| {
        let (n, sample) = (samples.count() as f64, &samples.values[k].sample);
        if samples.coupling.is_none() {
            return Tail::new(n, sample.kurtosis(), range);
        }
        let own = (sample.kurtosis(), sample.largest_deviation());
        let kurtosis = if own.0.is_nan() { own.0 } else { own.0.max(below.0) };
        let reach = own.1.max(below.1);
        below = own;
        Tail::new(n, kurtosis, if reach > 0.0 { reach } else { range })
    };
    levels.iter().map(tail).collect()
}

/// Whether fewer than [`EVENTS`] fine paths carry the variance of test function number k, or its
/// [`tail_index`] is below two, and the events are not of one size: larger ones may be missing,
/// whose size is not known. φ of two values has events of one size. Asked of the level that a sum
/// begins with.
pub fn is_heavy(samples: &Samples, k: usize) -> bool {
    let fine = &samples.values[k].fine;
    let few = || (samples.count() as f64) < EVENTS * fine.kurtosis();
    (few() || tail_index(samples, k) < LEAST_INDEX) && !fine.is_two_valued()
}

/// Hill's estimate of the exponent α in P(|φ − Eφ| > x) ∝ x^{−α} from the largest sixteenth of the
/// deviations of fine paths, 64 at most (Hill, *Ann. Statist.* 3, 1975); infinite if they are of
/// one size. With α ≤ 2 there is no variance, and where a sample shows α ≤ 2, as that of e^{3W}
/// does, it is far below the true one.
pub fn tail_index(samples: &Samples, k: usize) -> f64 {
    let values = &samples.values[k];
    let deviations = values.extremes.deviations(values.fine.mean());
    let number = (samples.count() / 16).min(deviations.len().saturating_sub(1) as u64) as usize;
    let logarithm = |x: f64| Real::ln(x / deviations[number]);
    let sum: f64 = deviations[..number].iter().map(|&x| logarithm(x)).sum();
    if sum > 0.0 { number as f64 / sum } else { f64::INFINITY }
}

/// Below this tail index a sample does not know its variance.
const LEAST_INDEX: f64 = 2.0;
/// How many of the largest and of the smallest samples are kept.
const KEPT: usize = 65;

/// The largest and the smallest samples.
#[derive(Clone, Default, Serialize, Deserialize)]
pub struct Extremes {
    largest: Vec<f64>,
    smallest: Vec<f64>,
    /// No samples between these count any more.
    passed: Option<(f64, f64)>,
}

impl Extremes {
    /// Adds these paths of a block.
    pub fn add(&mut self, x: &Row, paths: PathMask) {
        if self.largest.is_empty() {
            self.largest.reserve(4 * WIDTH);
            self.smallest.reserve(4 * WIDTH);
        }
        self.extend(paths.paths().map(|p| x[p]), paths.paths().map(|p| x[p]));
    }

    pub fn merge(&mut self, later: &Self) {
        if let Some((below, above)) = later.passed {
            let (low, high) = self.passed.unwrap_or((f64::INFINITY, f64::NEG_INFINITY));
            self.passed = Some((low.min(below), high.max(above)));
        }
        self.extend(later.largest.iter().copied(), later.smallest.iter().copied());
    }

    /// Keeps those that count, if there are many.
    fn extend(&mut self, large: impl Iterator<Item = f64>, small: impl Iterator<Item = f64>) {
        let (below, above) = self.passed.unwrap_or((f64::INFINITY, f64::NEG_INFINITY));
        self.largest.extend(large.filter(|&x| x > above));
        self.smallest.extend(small.filter(|&x| x < below));
        if self.largest.len().max(self.smallest.len()) > 4 * KEPT {
            let kept = |samples: &mut Vec<f64>, order: fn(&f64, &f64) -> Ordering| {
                if samples.len() > KEPT {
                    samples.select_nth_unstable_by(KEPT - 1, order);
                    samples.truncate(KEPT);
                }
                samples.get(KEPT - 1).copied()
            };
            let above = kept(&mut self.largest, |a, b| b.total_cmp(a));
            let below = kept(&mut self.smallest, f64::total_cmp);
            self.passed = below.zip(above);
        }
    }

    /// The largest distances from the mean, the largest first.
    fn deviations(&self, mean: f64) -> Vec<f64> {
        let above = self.largest.iter().map(|x| x - mean);
        let below = self.smallest.iter().map(|x| mean - x);
        let mut deviations: Vec<f64> = above.chain(below).filter(|&x| x > 0.0).collect();
        deviations.sort_unstable_by(|a, b| b.total_cmp(a));
        deviations.truncate(KEPT);
        deviations
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multilevel::{level::Values, resolution::Motion};

    const ONE: PathMask = PathMask(1);

    /// P(X ≤ k), X Poisson with mean λ.
    fn poisson(k: i32, mean: f64) -> f64 {
        let terms = (0..=k).scan((-mean).exp(), |term, j| {
            let now = *term;
            *term *= mean / f64::from(j + 1);
            Some(now)
        });
        terms.sum()
    }

    #[test]
    fn poisson_numbers_are_covered_with_the_tail_and_not_without() {
        let covered = |mean: f64, tailed: bool| {
            let inside = |k: i32| {
                let k = f64::from(k);
                let tail = Tail::new(1e6, if k > 0.0 { 1e6 / k } else { f64::NAN }, 1.0).size;
                let tail = if tailed { tail } else { 0.0 };
                (k - mean).abs() <= (1.96 * 1.96 * k + tail * tail).sqrt()
            };
            let probability =
                |k: i32| poisson(k, mean) - if k > 0 { poisson(k - 1, mean) } else { 0.0 };
            (0..200).filter(|&k| inside(k)).map(probability).sum::<f64>()
        };
        for tenths in 1..800 {
            let mean = 0.1 * f64::from(tenths);
            assert!(covered(mean, true) > 0.925, "{mean}: {}", covered(mean, true));
        }
        // The rule before: an interval of no width where no event is seen.
        assert!(covered(1.0, false) < 0.65 && covered(3.0, false) < 0.91);
    }

    #[test]
    fn the_tail_index_of_powers() {
        // u^{−1/α} at the middles of n intervals, and their negatives, shifted: deviations fall
        // like x^{−α}. Hill's estimate from 64 of them scatters by an eighth; from the middles it
        // does not.
        for (alpha, n) in [(1.0, 4000), (3.0, 4000), (3.0, 100_000)] {
            let mut values = Values::default();
            for i in 0..n {
                let u: f64 = (f64::from(i) + 0.5) / f64::from(n);
                for sign in [1.0, -1.0] {
                    values.fine.add(100.0 + sign * u.powf(-1.0 / alpha));
                    values.extremes.add(&[100.0 + sign * u.powf(-1.0 / alpha); WIDTH], ONE);
                }
            }
            let samples = single(values, 2 * n as u64);
            assert!((tail_index(&samples, 0) / alpha - 1.0).abs() < 0.1, "{alpha} {n}");
            assert_eq!(is_heavy(&samples, 0), alpha < 2.0);
        }
    }

    fn single(values: Values, paths: u64) -> Samples {
        let (level, coupling, cost_per_path, failed) = (0, None, 8, 0);
        let (values, motion) = (vec![values], Motion::default());
        Samples { level, coupling, cost_per_path, values, motion, paths, failed }
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

    #[test]
    fn a_tail_ends_where_thirty_samples_carry_the_variance() {
        assert_eq!(Tail::new(1000.0, 3.0, 5.0), Tail { size: 0.0, enough: 90.0 });
        assert_eq!(Tail::new(1000.0, 40.0, 5.0), Tail { size: 5.0 * UNSEEN, enough: 1200.0 });
        assert_eq!(Tail::new(1000.0, f64::NAN, 0.5), Tail { size: 0.5 * UNSEEN, enough: 3e4 });
    }
}
