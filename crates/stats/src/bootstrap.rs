//! A bootstrap-t interval for a weighted sum of logarithms of means, resampling whole paths.
//!
//! θ = Σ_l g_l ln m_l with fixed weights, where m_l is the mean of x_l over the paths: the slope of
//! a fit is of this form, and the logarithm of a root-mean-square. The errors of one path at all
//! step sizes belong together, so whole paths are resampled, in the batches that [`CrossMoments`]
//! keeps (Efron and Tibshirani, *An Introduction to the Bootstrap*, 1993, §12.5):
//!
//! 1. draw batches with replacement, as many as there are; m*_l are their means, θ* = Σ g_l ln
//!    m*_l;
//! 2. with u_b = Σ_l g_l (x_bl/m*_l − n_b), the influence of batch b, the standard error is se* =
//!    √(Σ u_b²)/N*;
//! 3. t* = (θ* − θ)/se*; the interval is [θ − t*_{hi} se, θ − t*_{lo} se] with the quantiles of t*.
//!
//! Studentising lets the interval lean to the side on which a large error has not been seen yet; a
//! percentile interval leans to the other one. Draws are functions of the number of the resample
//! alone, so the interval is reproducible.

use std::sync::OnceLock;

use rand_xoshiro::{
    SplitMix64,
    rand_core::{Rng, SeedableRng},
};
use real::{Kernel, dispatch};

use crate::moments::{BATCHES, CrossMoments};

/// Resamples; with 399 the quantiles of 2½ % and 97½ % are the 10th smallest and the 10th largest.
const RESAMPLES: usize = 399;
/// The quantiles' rank for 95 %.
const RANK: usize = 10;
/// With fewer batches the quantiles of t* are those of a few values that come again and again.
const LEAST_BATCHES: usize = 32;

/// How far the interval reaches below and above θ, in standard errors of θ; `None` with fewer than
/// 32 paths.
///
/// `levels` are the components that the weights `gain` belong to.
pub fn reach(squares: &CrossMoments, levels: &[usize], gain: &[f64]) -> Option<(f64, f64)> {
    let counts: Vec<f64> = squares.batches().map(|(count, _)| count as f64).collect();
    let batches = counts.len();
    if batches < LEAST_BATCHES {
        return None;
    }
    // Scaled by their means, so that logarithms of means are differences to the estimate.
    let values: Vec<Vec<f64>> = levels
        .iter()
        .map(|&l| squares.batches().map(|(_, sums)| sums[l] / squares.mean(l)).collect())
        .collect();
    // With all the batches, which is nearly always, the draws are looked up: drawing takes twice as
    // long as the rest.
    static ALL: OnceLock<Vec<u16>> = OnceLock::new();
    let few;
    let draws = if batches == BATCHES {
        ALL.get_or_init(|| draws(BATCHES))
    } else {
        few = draws(batches);
        &few
    };
    let mut influences = vec![0.0; batches];
    let mut means = vec![0.0; levels.len()];
    let mut statistics: Vec<f64> = draws
        .chunks_exact(batches)
        .map(|times| {
            let times: Vec<f64> = times.iter().map(|&times| f64::from(times)).collect();
            let se = dispatch(Resample {
                times: &times,
                counts: &counts,
                values: &values,
                gain,
                means: &mut means,
                influences: &mut influences,
            });
            means.iter().zip(gain).map(|(mean, g)| g * mean.ln()).sum::<f64>() / se
        })
        .collect();
    statistics.sort_by(f64::total_cmp);
    let (low, high) = (statistics[RANK - 1], statistics[RESAMPLES - RANK]);
    (low.is_finite() && high.is_finite()).then_some((high, -low))
}

/// The means m*_l of one resample, and se*.
struct Resample<'a> {
    /// How often each batch was drawn.
    times: &'a [f64],
    counts: &'a [f64],
    values: &'a [Vec<f64>],
    gain: &'a [f64],
    means: &'a mut [f64],
    /// Room for u_b.
    influences: &'a mut [f64],
}

impl Kernel for Resample<'_> {
    type Output = f64;

    #[inline(always)]
    fn run(self) -> f64 {
        let Self { times, counts, values, gain, means, influences } = self;
        let count = dot(times, counts);
        let total: f64 = gain.iter().sum();
        for (influence, count) in influences.iter_mut().zip(counts) {
            *influence = -total * count;
        }
        for ((value, &g), mean) in values.iter().zip(gain).zip(means) {
            *mean = dot(times, value) / count;
            let weight = g / *mean;
            for (influence, x) in influences.iter_mut().zip(value) {
                *influence += weight * x;
            }
        }
        for influence in influences.iter_mut() {
            *influence *= *influence;
        }
        dot(times, influences).sqrt() / count
    }
}

/// a·b in eight partial sums, which vectorise.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (a_chunks, b_chunks) = (a.chunks_exact(8), b.chunks_exact(8));
    let mut rest = 0.0;
    for (a, b) in a_chunks.remainder().iter().zip(b_chunks.remainder()) {
        rest += a * b;
    }
    for (a, b) in a_chunks.zip(b_chunks) {
        for i in 0..8 {
            sums[i] += a[i] * b[i];
        }
    }
    let mut sum = 0.0;
    for partial in sums {
        sum += partial;
    }
    sum + rest
}

/// How often each of so many batches is drawn, resample by resample.
///
/// The numbers are those of SplitMix64 (Steele, Lea and Flood 2014) started at the number of the
/// resample times 2³²; the upper half of a word times the number of batches, over 2³², is uniform
/// up to 2⁻²⁴.
fn draws(batches: usize) -> Vec<u16> {
    let mut times = vec![0; RESAMPLES * batches];
    for (resample, times) in (0u64..).zip(times.chunks_exact_mut(batches)) {
        let mut words = SplitMix64::seed_from_u64(resample << 32);
        for _ in 0..batches {
            times[(((words.next_u64() >> 32) * batches as u64) >> 32) as usize] += 1;
        }
    }
    times
}

/// Degrees of freedom of the estimated variance of θ by Satterthwaite's rule (*Biometrics* 2,
/// 1946), 2B/(κ − 1) with κ the kurtosis of the influences u_b of the B batches: B for normal
/// influences, 2 when a single batch dominates.
pub fn degrees_of_freedom(squares: &CrossMoments, levels: &[usize], gain: &[f64]) -> f64 {
    let (mut batches, mut second, mut fourth) = (0.0, 0.0, 0.0);
    for (count, sums) in squares.batches() {
        let influence: f64 = levels
            .iter()
            .zip(gain)
            .map(|(&l, g)| g * (sums[l] / squares.mean(l) - count as f64))
            .sum();
        batches += 1.0;
        second += influence.powi(2);
        fourth += influence.powi(4);
    }
    let kurtosis: f64 = batches * fourth / (second * second);
    2.0 * batches / (kurtosis - 1.0).max(f64::EPSILON)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_resample_has_as_many_batches_as_there_are() {
        for batches in [32, 100, BATCHES] {
            let draws = draws(batches);
            assert_eq!(draws.len(), RESAMPLES * batches);
            for times in draws.chunks(batches) {
                assert_eq!(times.iter().map(|&times| usize::from(times)).sum::<usize>(), batches);
            }
        }
    }

    #[test]
    fn batches_are_drawn_evenly_and_every_resample_is_another() {
        // A batch is drawn 399 times in all, with the standard deviation √399 = 20; five of them
        // are exceeded by one of 256 batches with probability 1.5e-4.
        let draws = draws(BATCHES);
        for batch in 0..BATCHES {
            let times: u32 = draws.iter().skip(batch).step_by(BATCHES).map(|&n| u32::from(n)).sum();
            assert!(times.abs_diff(399) < 100, "{batch}: {times}");
        }
        let resamples: std::collections::HashSet<_> = draws.chunks(BATCHES).collect();
        assert_eq!(resamples.len(), RESAMPLES);
    }

    #[test]
    fn partial_sums_add_up() {
        for n in 0..30 {
            let a: Vec<f64> = (1..=n).map(f64::from).collect();
            let b: Vec<f64> = a.iter().map(|x| 2.0 * x - 7.0).collect();
            let n = f64::from(n);
            // Σ k(2k − 7), in integers.
            let exact = n * (n + 1.0) * (2.0 * n + 1.0) / 3.0 - 7.0 * n * (n + 1.0) / 2.0;
            assert_eq!(dot(&a, &b), exact);
        }
    }

    /// Skewed squares at two step sizes, which share a part.
    fn skewed(paths: u32) -> CrossMoments {
        let mut squares = CrossMoments::new(2);
        for path in 0..paths {
            let (shared, own) = (f64::from(path * path % 11), f64::from(path % 5));
            squares.add(&[1.0 + shared * shared, 3.0 + 0.5 * shared + own]);
        }
        squares
    }

    /// The ends of the interval by the steps 1 to 3 of this module, word for word.
    fn by_definition(squares: &CrossMoments, levels: &[usize], gain: &[f64]) -> (f64, f64) {
        let batches: Vec<(u64, &[f64])> = squares.batches().collect();
        let theta = |mean: &dyn Fn(usize) -> f64| -> f64 {
            levels.iter().zip(gain).map(|(&l, g)| g * mean(l).ln()).sum()
        };
        let estimate = theta(&|l| squares.mean(l));
        let draws = draws(batches.len());
        let statistic = |times: &[u16]| {
            let over = |f: &dyn Fn(u64, &[f64]) -> f64| -> f64 {
                batches.iter().zip(times).map(|(&(n, x), &times)| f64::from(times) * f(n, x)).sum()
            };
            let count = over(&|n, _| n as f64);
            let mean = |l: usize| over(&|_, x| x[l]) / count;
            let influence = |n: u64, x: &[f64]| -> f64 {
                levels.iter().zip(gain).map(|(&l, g)| g * (x[l] / mean(l) - n as f64)).sum()
            };
            let se = over(&|n, x| influence(n, x).powi(2)).sqrt() / count;
            (theta(&mean) - estimate) / se
        };
        let mut statistics: Vec<f64> = draws.chunks(batches.len()).map(statistic).collect();
        statistics.sort_by(f64::total_cmp);
        // 2½ % of 399 are below the tenth, and as many above the tenth from above.
        (statistics[389], -statistics[9])
    }

    #[test]
    fn the_interval_is_the_one_defined() {
        for paths in [32, 100, 256, 1000] {
            let squares = skewed(paths);
            for (levels, gain) in [(&[1][..], &[0.5][..]), (&[0, 1], &[0.7, -0.4])] {
                let (below, above) = reach(&squares, levels, gain).unwrap();
                let (low, high) = by_definition(&squares, levels, gain);
                assert!((below / low - 1.0).abs() < 1e-9, "{paths}: {below} {low}");
                assert!((above / high - 1.0).abs() < 1e-9, "{paths}: {above} {high}");
            }
        }
        assert_eq!(reach(&skewed(31), &[0], &[1.0]), None);
    }

    #[test]
    fn an_interval_without_an_end_is_none() {
        // Of 32 squares one is 33 and the others are 1. A third of the resamples has only ones, at
        // which the standard error is zero and the lower end is infinite; the upper end is not.
        let mut squares = CrossMoments::new(2);
        for path in 0..32 {
            squares.add(&[if path == 5 { 33.0 } else { 1.0 }, 2.0]);
        }
        assert_eq!(reach(&squares, &[0], &[1.0]), None);
        // Nor has it ends where all squares are the same.
        assert_eq!(reach(&squares, &[1], &[1.0]), None);
    }

    #[test]
    fn degrees_of_freedom_follow_from_the_kurtosis() {
        // Squares 1, 2, 3, 6 and 4, 5, 7, 8 of four paths: by the weights (1, 0) the influences are
        // −⅔, −⅓, 0, 1, with the kurtosis 4·(98/81)/(14/9)² = 2, hence 2·4/(2 − 1). By (1, 2) they
        // are −4/3, −⅔, ⅓, 5/3.
        let mut squares = CrossMoments::new(2);
        for x in [[1.0, 4.0], [2.0, 5.0], [3.0, 7.0], [6.0, 8.0]] {
            squares.add(&x);
        }
        let of = |levels: &[usize], gain: &[f64]| degrees_of_freedom(&squares, levels, gain);
        assert!((of(&[0], &[1.0]) - 8.0).abs() < 1e-12);
        assert!((of(&[0], &[-3.0]) - 8.0).abs() < 1e-12);
        let influences = [-4.0 / 3.0, -2.0 / 3.0, 1.0 / 3.0, 5.0 / 3.0];
        let sum = |k: i32| influences.iter().map(|u: &f64| u.powi(k)).sum::<f64>();
        let exact = 8.0 / (4.0 * sum(4) / sum(2).powi(2) - 1.0);
        let found = of(&[0, 1], &[1.0, 2.0]);
        assert!((found - exact).abs() < 1e-12, "{found} {exact}");
    }
}
