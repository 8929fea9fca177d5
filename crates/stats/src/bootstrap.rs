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
}
