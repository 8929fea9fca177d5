//! Averages over time of a stationary series whose samples are correlated.

use serde::{Deserialize, Serialize};

use crate::quantile::{CONFIDENCE, two_sided, variance_ratio_p_value};

/// Most batches that are kept. When there are so many, neighbours are merged.
const MOST_BATCHES: usize = 1024;
/// A series with fewer samples is refused: half as many as batches are kept at most.
pub const FEWEST_SAMPLES: u64 = MOST_BATCHES as u64 / 2;
/// The interval is made from at least so many batches, and from fewer than twice as many of one
/// series. More degrees of freedom hardly narrow it, longer batches are less correlated (Schmeiser,
/// *Oper. Res.* 30, 1982).
const BATCHES_OF_INTERVAL: usize = 32;
/// Neighbouring batches may have this correlation and no more.
const MOST_CORRELATION: f64 = 0.5;
/// Chains disagree if so large a difference of their means has a smaller probability.
const LEAST_PROBABILITY: f64 = 1e-4;

/// Collects one stationary series, sample by sample, for the average with an interval.
///
/// Sums over batches of consecutive samples are kept, at most 1024 of them: when there are so many,
/// neighbours are merged and the batch length doubles. So memory does not grow with the length.
///
/// The interval is that of batch means, with Student's quantile, from 32 to 63 batches. Their
/// variance is too small by a factor 1 − T/b, where b is the batch length and T = 2Σkγₖ/Σγₖ, with
/// sums over all lags k > 0 and all k, a time of decorrelation. To keep it near one, neighbouring
/// batches may have a correlation of at most ½ at every length from about n/1024 to n/32, where n
/// counts all samples. For correlations that decay exponentially, ½ at b/16 means T ≈ b/19: 2.6 %
/// of the standard error.
///
/// A part of the motion that is slower than the whole series is not seen by any such rule; several
/// chains from different starts see it ([`of_chains`](Self::of_chains)).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TimeAverage {
    /// The first sample. All sums are of differences from it, which loses no digits.
    origin: f64,
    count: u64,
    sum: f64,
    sum_of_squares: f64,
    /// Samples in a batch, a power of two; zero without samples.
    batch_length: u64,
    /// Sums of the batches that are complete.
    batches: Vec<f64>,
    /// Sum of the batch that is not.
    rest: f64,
}

/// An average over time with its interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StationaryMean {
    /// The mean of all samples.
    pub mean: f64,
    /// Its standard error.
    pub se: f64,
    /// Lower end of the 95 % interval.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
    /// Degrees of freedom of the standard error.
    pub degrees: f64,
    /// The integrated autocorrelation time Σγₖ/γ₀ over all lags k, positive and negative, in
    /// samples: 1 for independent ones, below 1 where they alternate. 1 for a constant.
    pub correlation_time: f64,
    /// So many independent samples would have the same standard error.
    pub effective_samples: f64,
}

/// A series whose average has no interval.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TimeAverageError {
    /// There are too few samples to say how they are correlated.
    #[error("a time average needs at least {needed} samples of each chain, got {count}")]
    TooFew {
        /// The number of samples.
        count: u64,
        /// The least number.
        needed: u64,
    },
    /// The series is too short for its correlation time.
    #[error(
        "the series is too short for its correlation time: neighbouring averages over \
         {batch_length} samples have correlation {correlation:.2}; average over a longer time"
    )]
    Correlated {
        /// Samples in a batch.
        batch_length: u64,
        /// Correlation of neighbouring batches.
        correlation: f64,
    },
    /// Chains have different means.
    #[error(
        "the chains do not have the same mean (p = {p_value:.1e}): average over a longer time, or \
         let them forget their start first"
    )]
    Disagree {
        /// Probability of so different means.
        p_value: f64,
    },
    /// A sample is not a number, or sums overflow.
    #[error("the series has a sample that is not finite, or its squares overflow")]
    NotFinite,
}

impl TimeAverage {
    /// Adds the next sample.
    pub fn add(&mut self, x: f64) {
        if self.count == 0 {
            self.origin = x;
            self.batch_length = 1;
        }
        let x = x - self.origin;
        self.count += 1;
        self.sum += x;
        self.sum_of_squares += x * x;
        self.rest += x;
        if self.count.is_multiple_of(self.batch_length) {
            self.batches.push(std::mem::take(&mut self.rest));
            if self.batches.len() == MOST_BATCHES {
                self.batches = merged(&self.batches);
                self.batch_length *= 2;
            }
        }
    }

    /// Number of samples.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The mean of all samples; NaN without any.
    pub fn mean(&self) -> f64 {
        self.origin + self.sum / self.count as f64
    }

    /// The mean with its interval.
    ///
    /// # Errors
    /// [`TimeAverageError`] if the series is too short or not finite.
    pub fn interval(&self) -> Result<StationaryMean, TimeAverageError> {
        Self::of_chains(std::slice::from_ref(self))
    }

    /// The mean of several independent series of the same law, of any lengths. From 32 series on
    /// every one is a batch, whatever its correlation time is.
    ///
    /// # Errors
    /// [`TimeAverageError`] if a series is too short or not finite, or means differ by more than
    /// their errors.
    pub fn of_chains(chains: &[Self]) -> Result<StationaryMean, TimeAverageError> {
        let fewest = chains.iter().map(|chain| chain.count).min().unwrap_or(0);
        if fewest < FEWEST_SAMPLES {
            return Err(TimeAverageError::TooFew { count: fewest, needed: FEWEST_SAMPLES });
        }
        if chains.iter().any(|chain| !(chain.origin + chain.sum_of_squares).is_finite()) {
            return Err(TimeAverageError::NotFinite);
        }
        let count: f64 = chains.iter().map(|chain| chain.count as f64).sum();
        let share = |chain: &Self| chain.count as f64 / count;
        // All means are distances from the first sample.
        let origin = chains[0].origin;
        let mean: f64 = chains.iter().map(|chain| share(chain) * chain.distance(origin)).sum();
        let spread = |chain: &Self| share(chain) * chain.spread(chain.distance(origin) - mean);
        let variance: f64 = chains.iter().map(spread).sum();
        let (square, degrees) = if chains.len() < BATCHES_OF_INTERVAL {
            square_of_batches(chains, mean, count)?
        } else {
            square_of_chains(chains, mean, count)
        };
        let mean = origin + mean;
        let se = square.sqrt();
        let half = if se > 0.0 { two_sided(CONFIDENCE, Some(degrees)) * se } else { 0.0 };
        let correlation_time = if variance > 0.0 { square * count / variance } else { 1.0 };
        Ok(StationaryMean {
            mean,
            se,
            lo: mean - half,
            hi: mean + half,
            degrees,
            correlation_time,
            effective_samples: count / correlation_time,
        })
    }

    /// The mean less `origin`.
    fn distance(&self, origin: f64) -> f64 {
        self.origin - origin + self.sum / self.count as f64
    }

    /// The mean square of the distance to a point so far from the mean.
    fn spread(&self, distance: f64) -> f64 {
        let n = self.count as f64;
        (self.sum_of_squares / n - (self.sum / n).powi(2)).max(0.0) + distance * distance
    }

    /// Means of batches of this length, which is a multiple of the own, less `origin`.
    fn batch_means(&self, length: u64, origin: f64) -> Vec<f64> {
        let mut sums = self.batches.clone();
        for _ in 0..(length / self.batch_length).ilog2() {
            sums = merged(&sums);
        }
        let shift = self.origin - origin;
        sums.iter().map(|sum| shift + sum / length as f64).collect()
    }
}

/// Sums of neighbours; without the last if their number is odd.
fn merged(batches: &[f64]) -> Vec<f64> {
    batches.chunks_exact(2).map(|pair| pair[0] + pair[1]).collect()
}

/// The squared standard error of the mean from batches, and its degrees of freedom.
fn square_of_batches(
    chains: &[TimeAverage],
    mean: f64,
    count: f64,
) -> Result<(f64, f64), TimeAverageError> {
    let origin = chains[0].origin;
    let mut length = chains.iter().map(|chain| chain.batch_length).max().unwrap_or(1);
    while count > (MOST_BATCHES as u64 * length) as f64 {
        length *= 2;
    }
    loop {
        let means: Vec<Vec<f64>> =
            chains.iter().map(|chain| chain.batch_means(length, origin)).collect();
        let correlation = neighbours_correlation(&means, mean);
        if correlation > MOST_CORRELATION {
            return Err(TimeAverageError::Correlated { batch_length: length, correlation });
        }
        let longer: usize = means.iter().map(|means| means.len() / 2).sum();
        let every = means.iter().all(|means| means.len() >= 2);
        if longer >= BATCHES_OF_INTERVAL && every {
            length *= 2;
            continue;
        }
        let batches: usize = means.iter().map(Vec::len).sum();
        let degrees = (batches - chains.len()) as f64;
        let within: f64 = means.iter().map(|means| squares_about_mean(means)).sum();
        let square = within / degrees;
        if chains.len() > 1 {
            let between = (chains.len() - 1) as f64;
            let squares: f64 = chains
                .iter()
                .map(|chain| {
                    (chain.distance(origin) - mean).powi(2) * chain.count as f64 / length as f64
                })
                .sum();
            let p_value = variance_ratio_p_value(squares / between / square, between, degrees);
            if p_value < LEAST_PROBABILITY {
                return Err(TimeAverageError::Disagree { p_value });
            }
        }
        return Ok((square * length as f64 / count, degrees));
    }
}

/// The squared standard error from the scatter of chains, which need not have equal lengths: the
/// sum of (nᵢ/n)²(x̄ᵢ − x̄)², as if each chain had a variance of its own.
fn square_of_chains(chains: &[TimeAverage], mean: f64, count: f64) -> (f64, f64) {
    let (degrees, origin) = ((chains.len() - 1) as f64, chains[0].origin);
    let part = |chain: &TimeAverage| {
        (chain.count as f64 / count * (chain.distance(origin) - mean)).powi(2)
    };
    (chains.iter().map(part).sum::<f64>() * chains.len() as f64 / degrees, degrees)
}

/// The correlation of neighbouring batches, all about one mean; zero where there is no scatter.
fn neighbours_correlation(means: &[Vec<f64>], mean: f64) -> f64 {
    let (mut products, mut squares, mut pairs, mut count) = (0.0, 0.0, 0.0, 0.0);
    for chain in means {
        for pair in chain.windows(2) {
            products += (pair[0] - mean) * (pair[1] - mean);
            pairs += 1.0;
        }
        squares += chain.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
        count += chain.len() as f64;
    }
    if squares > 0.0 && pairs > 0.0 { products / pairs * count / squares } else { 0.0 }
}

/// Σ(x − x̄)².
fn squares_about_mean(x: &[f64]) -> f64 {
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    x.iter().map(|x| (x - mean).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(samples: impl IntoIterator<Item = f64>) -> TimeAverage {
        let mut average = TimeAverage::default();
        samples.into_iter().for_each(|x| average.add(x));
        average
    }

    #[test]
    fn batches_are_sums_of_neighbours() {
        // Integers, so that nothing is rounded.
        let samples: Vec<f64> = (0..5000).map(|n| f64::from(n * n % 101)).collect();
        let average = of(samples.iter().copied());
        assert_eq!((average.batch_length, average.batches.len()), (8, 625));
        for (n, batch) in average.batches.iter().enumerate() {
            let sum: f64 = samples[8 * n..8 * n + 8].iter().map(|x| x - samples[0]).sum();
            assert_eq!(*batch, sum);
        }
        let mean = samples.iter().sum::<f64>() / 5000.0;
        assert!((average.mean() - mean).abs() < 1e-12);
        assert_eq!(average.batch_means(64, 0.0).len(), 78);
        assert_eq!(average.batch_means(64, 0.0)[1], samples[64..128].iter().sum::<f64>() / 64.0);
    }

    #[test]
    fn memory_does_not_grow() {
        let average = of((0..1_000_000).map(|n| f64::from(n % 17)));
        assert!(average.batches.len() < MOST_BATCHES && average.batches.capacity() <= MOST_BATCHES);
        assert_eq!(average.count(), 1_000_000);
    }

    #[test]
    fn a_constant_is_its_mean() {
        let found = of([0.1; 600]).interval().unwrap();
        assert_eq!((found.mean, found.se, found.lo, found.hi), (0.1, 0.0, 0.1, 0.1));
        assert_eq!((found.correlation_time, found.effective_samples), (1.0, 600.0));
        let chains = vec![of([0.1; 600]); 2];
        assert_eq!(TimeAverage::of_chains(&chains).unwrap().se, 0.0);
    }

    #[test]
    fn a_large_mean_costs_no_digits() {
        let noise = |n: u64| (n.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as f64 / 4096.0;
        let near = of((0..4096).map(noise)).interval().unwrap();
        let far = of((0..4096).map(|n| noise(n) + 1e9)).interval().unwrap();
        assert!((far.se / near.se - 1.0).abs() < 1e-6);
        assert!((far.correlation_time / near.correlation_time - 1.0).abs() < 1e-6);
    }

    #[test]
    fn what_has_no_interval_is_refused() {
        let refused = |average: TimeAverage| average.interval().unwrap_err();
        assert_eq!(refused(of([1.0; 511])), TimeAverageError::TooFew { count: 511, needed: 512 });
        assert_eq!(refused(TimeAverage::default()).to_string().split(',').count(), 2);
        assert_eq!(TimeAverage::of_chains(&[]).unwrap_err(), refused(TimeAverage::default()));
        for bad in [f64::NAN, f64::INFINITY, 1e200] {
            let series = (0..600).map(|n| if n == 300 { bad } else { 0.0 });
            assert_eq!(refused(of(series)), TimeAverageError::NotFinite, "{bad}");
        }
        // A slope is correlated at any length.
        match refused(of((0..100_000).map(f64::from))) {
            TimeAverageError::Correlated { batch_length: 128, correlation } => {
                assert!(correlation > 0.9);
            }
            other => panic!("{other}"),
        }
    }
}
