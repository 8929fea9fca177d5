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

use real::{Kernel, dispatch};

use crate::{BATCHES, CrossMoments};

/// Resamples; with 399 the quantiles of 2½ % and 97½ % are the 10th smallest and the 10th largest.
const RESAMPLES: u64 = 399;
/// The quantiles' rank for 95 %.
const RANK: usize = 10;
/// With fewer batches the quantiles of t* are those of a few values that come again and again.
const LEAST_BATCHES: usize = 32;

/// How far the interval reaches below and above θ, in standard errors of θ; `None` with fewer than
/// 32 paths.
///
/// `levels` are the components that the weights `gain` belong to.
pub(super) fn reach(squares: &CrossMoments, levels: &[usize], gain: &[f64]) -> Option<(f64, f64)> {
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
    let mut statistics = Vec::with_capacity(RESAMPLES as usize);
    let (mut times, mut influences, mut means) =
        (vec![0.0; batches], vec![0.0; batches], vec![0.0; levels.len()]);
    for resample in 0..RESAMPLES {
        drawn(resample, &mut times);
        let se = dispatch(Resample {
            times: &times,
            counts: &counts,
            values: &values,
            gain,
            means: &mut means,
            influences: &mut influences,
        });
        let shift: f64 = means.iter().zip(gain).map(|(mean, g)| g * mean.ln()).sum();
        statistics.push(shift / se);
    }
    statistics.sort_by(f64::total_cmp);
    let (low, high) = (statistics[RANK - 1], statistics[RESAMPLES as usize - RANK]);
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

/// Degrees of freedom of the estimated variance of θ by Satterthwaite's rule, 2B/(κ − 1) with κ the
/// kurtosis of the influences u_b of the B batches: B for normal influences, 2 when a single batch
/// dominates.
pub(super) fn degrees_of_freedom(squares: &CrossMoments, levels: &[usize], gain: &[f64]) -> f64 {
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

/// How often each batch is drawn in a resample. With all [`BATCHES`] of them, which is nearly
/// always, it is looked up: drawing takes twice as long as the rest.
fn drawn(resample: u64, times: &mut [f64]) {
    static ALL: OnceLock<Vec<u16>> = OnceLock::new();
    if times.len() == BATCHES {
        let all = ALL.get_or_init(|| {
            let mut all = vec![0; RESAMPLES as usize * BATCHES];
            for (resample, times) in (0..).zip(all.chunks_exact_mut(BATCHES)) {
                draw(resample, BATCHES as u64, |batch| times[batch] += 1);
            }
            all
        });
        let row = &all[resample as usize * BATCHES..][..BATCHES];
        times.iter_mut().zip(row).for_each(|(times, &drawn)| *times = f64::from(drawn));
    } else {
        times.fill(0.0);
        draw(resample, times.len() as u64, |batch| times[batch] += 1.0);
    }
}

/// Draws as many batches as there are.
///
/// The numbers are those of SplitMix64 (Steele, Lea and Flood 2014) started at the number of the
/// resample times 2³²; the upper half of a word times the number of batches, over 2³², is uniform
/// up to 2⁻²⁴.
fn draw(resample: u64, batches: u64, mut count: impl FnMut(usize)) {
    let mut counter = resample << 32;
    for _ in 0..batches {
        counter = counter.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut word = counter;
        word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        word ^= word >> 31;
        count((((word >> 32) * batches) >> 32) as usize);
    }
}

/// A 95 % interval for the root of the mean square of component `l`, by bootstrap-t for its
/// logarithm. It leans upwards, as it must for skewed squares, where value ± 1.96 standard errors
/// covers too rarely. `None` with fewer than 32 paths.
#[must_use]
pub fn root_mean_square_interval(squares: &CrossMoments, l: usize) -> Option<(f64, f64)> {
    let mean = squares.mean(l);
    let se = 0.5 * squares.covariance_of_means(l, l).sqrt() / mean;
    let (below, above) = reach(squares, &[l], &[0.5])?;
    Some((mean.sqrt() * (-below * se).exp(), mean.sqrt() * (above * se).exp()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_looked_up_is_what_is_drawn() {
        for resample in [0, 1, 57, RESAMPLES - 1] {
            let (mut looked_up, mut counted) = (vec![0.0; BATCHES], vec![0.0; BATCHES]);
            drawn(resample, &mut looked_up);
            draw(resample, BATCHES as u64, |batch| counted[batch] += 1.0);
            assert_eq!(looked_up, counted);
            assert_eq!(looked_up.iter().sum::<f64>(), BATCHES as f64);
        }
    }
}
