//! A bootstrap-t interval for a weighted sum of logarithms of means, resampling whole paths.
//!
//! θ = Σ_l g_l ln m_l with fixed weights Σ g_l = 0, where m_l is the mean of x_l over the paths: the slope of a fit is of this
//! form. The errors of one path at all step sizes belong together, so whole paths are resampled, in the batches that
//! [`CrossMoments`] keeps (Efron and Tibshirani, *An Introduction to the Bootstrap*, 1993, §12.5):
//!
//! 1. draw batches with replacement, as many as there are; m*_l are their means, θ* = Σ g_l ln m*_l;
//! 2. with u_b = Σ_l g_l x_bl/m*_l, the influence of batch b, the standard error is se* = √(Σ u_b²)/N*;
//! 3. t* = (θ* − θ)/se*; the interval is [θ − t*_{hi} se, θ − t*_{lo} se] with the quantiles of t*.
//!
//! Studentising lets the interval lean to the side on which a large error has not been seen yet; a percentile interval
//! leans to the other one. Draws are functions of the number of the resample alone, so the interval is reproducible.

use mc::CrossMoments;

/// Resamples; with 799 the quantiles of 2½ % and 97½ % are the 20th smallest and the 20th largest.
const RESAMPLES: u64 = 799;
/// The quantiles' rank for 95 %.
const RANK: usize = 20;
/// With fewer batches the quantiles of t* are those of a few values that come again and again.
const LEAST_BATCHES: usize = 32;

/// How far the interval reaches below and above θ, in standard errors of θ; `None` with fewer than 32 paths.
///
/// `levels` are the components that the weights `gain` belong to.
pub(super) fn reach(squares: &CrossMoments, levels: &[usize], gain: &[f64]) -> Option<(f64, f64)> {
    let width = levels.len();
    let mut counts = Vec::new();
    // Scaled by their means, so that logarithms of means are differences to the estimate.
    let mut values = Vec::new();
    for (count, sums) in squares.batches() {
        counts.push(count as f64);
        values.extend(levels.iter().map(|&l| sums[l] / squares.mean(l)));
    }
    let batches = counts.len();
    if batches < LEAST_BATCHES {
        return None;
    }
    let mut statistics = Vec::with_capacity(RESAMPLES as usize);
    let (mut times, mut weights) = (vec![0.0; batches], vec![0.0; width]);
    for resample in 0..RESAMPLES {
        times.fill(0.0);
        draw(resample, batches as u64, &mut times);
        let mut means = vec![0.0; width];
        let mut count = 0.0;
        for b in 0..batches {
            count += times[b] * counts[b];
            for (mean, value) in means.iter_mut().zip(&values[b * width..]) {
                *mean += times[b] * value;
            }
        }
        let mut shift = 0.0;
        for l in 0..width {
            means[l] /= count;
            weights[l] = gain[l] / means[l];
            shift += gain[l] * means[l].ln();
        }
        let squared: f64 = (0..batches)
            .map(|b| {
                let influence: f64 = weights.iter().zip(&values[b * width..]).map(|(w, value)| w * value).sum();
                times[b] * influence * influence
            })
            .sum();
        statistics.push(shift / (squared.sqrt() / count));
    }
    statistics.sort_by(f64::total_cmp);
    let (low, high) = (statistics[RANK - 1], statistics[RESAMPLES as usize - RANK]);
    (low.is_finite() && high.is_finite()).then_some((high, -low))
}

/// Degrees of freedom of the estimated variance of θ by Satterthwaite's rule, 2B/(κ − 1) with κ the kurtosis of the
/// influences u_b of the B batches: B for normal influences, 2 when a single batch dominates.
pub(super) fn degrees_of_freedom(squares: &CrossMoments, levels: &[usize], gain: &[f64]) -> f64 {
    let (mut batches, mut second, mut fourth) = (0.0, 0.0, 0.0);
    for (_, sums) in squares.batches() {
        let influence: f64 = levels.iter().zip(gain).map(|(&l, g)| g * sums[l] / squares.mean(l)).sum();
        batches += 1.0;
        second += influence.powi(2);
        fourth += influence.powi(4);
    }
    let kurtosis: f64 = batches * fourth / (second * second);
    2.0 * batches / (kurtosis - 1.0).max(f64::EPSILON)
}

/// How often each batch is drawn in a resample.
///
/// The numbers are those of SplitMix64 (Steele, Lea and Flood 2014) started at the number of the resample times 2³²;
/// the upper half of a word times the number of batches, over 2³², is uniform up to 2⁻²⁴.
fn draw(resample: u64, batches: u64, times: &mut [f64]) {
    let mut counter = resample << 32;
    for _ in 0..batches {
        counter = counter.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut word = counter;
        word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        word ^= word >> 31;
        times[((word >> 32) * batches >> 32) as usize] += 1.0;
    }
}
