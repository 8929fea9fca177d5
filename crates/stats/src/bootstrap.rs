//! A bootstrap-t interval for a weighted sum of logarithms of means, resampling whole paths.
//!
//! θ = Σ_l g_l ln m_l with fixed weights, where m_l is the mean of x_l over the paths: the slope of
//! a fit is of this form, and the logarithm of a root-mean-square. The errors of one path at all
//! step sizes belong together, so whole paths are resampled, in the batches that [`CrossMoments`]
//! keeps (Efron and Tibshirani, *An Introduction to the Bootstrap*, 1993, §12.5):
//!
//! 1. draw batches with replacement, each resample of the size of the original; m*_l are their
//!    means, θ* = Σ g_l ln m*_l;
//! 2. with u_b = Σ_l g_l (x_bl/m*_l − n_b), the influence of batch b, the standard error is se* =
//!    √(Σ u_b²)/N*;
//! 3. t* = (θ* − θ)/se*; the interval is [θ − t*_{hi} se, θ − t*_{lo} se] with the quantiles of t*.
//!
//! Studentising lets the interval lean to the side on which a large error has not been seen yet; a
//! percentile interval leans to the other one. Draws are functions of the number of the resample
//! alone, so the interval is reproducible.

use rand_xoshiro::{
    SplitMix64,
    rand_core::{Rng, SeedableRng},
};
use real::elementary;

use crate::moments::CrossMoments;

/// Number of resamples; with 399, the quantiles of 2½ % and 97½ % are the 10th smallest and the
/// 10th largest.
const RESAMPLES: usize = 399;
/// Rank of the quantiles of t* for 95 %.
const RANK: usize = 10;
/// Least number of batches: with fewer, the quantiles of t* are those of a few repeated values.
const MIN_BATCHES: usize = 32;

/// Distances from θ to the lower and the upper end of the interval, in standard errors of θ; `None`
/// with fewer than 32 paths.
///
/// `levels` are the components that the weights `gain` belong to.
pub fn reach(squares: &CrossMoments, levels: &[usize], gain: &[f64]) -> Option<(f64, f64)> {
    let counts: Vec<f64> = squares.batches().map(|(count, _)| count as f64).collect();
    let (batches, total) = (counts.len(), gain.iter().sum::<f64>());
    if batches < MIN_BATCHES {
        return None;
    }
    // Scaled by their means, so that logarithms of means are differences to the estimate.
    let values =
        |&l: &usize| squares.batches().map(|(_, sums)| sums[l] / squares.mean(l)).collect();
    let values: Vec<Vec<f64>> = levels.iter().map(values).collect();
    let statistic = |resample: usize| {
        let times = draw(resample as u64, batches);
        let count = dot(&times, &counts);
        let mut influences: Vec<f64> = counts.iter().map(|count| -total * count).collect();
        let mut theta = 0.0;
        for (value, g) in values.iter().zip(gain) {
            let mean = dot(&times, value) / count;
            let weight = g / mean;
            influences.iter_mut().zip(value).for_each(|(u, x)| *u += weight * x);
            theta += g * elementary::ln(mean);
        }
        influences.iter_mut().for_each(|u| *u *= *u);
        theta / (dot(&times, &influences).sqrt() / count)
    };
    let mut statistics: Vec<f64> = (0..RESAMPLES).map(statistic).collect();
    statistics.sort_by(f64::total_cmp);
    let (low, high) = (statistics[RANK - 1], statistics[RESAMPLES - RANK]);
    (low.is_finite() && high.is_finite()).then_some((high, -low))
}

/// Scalar product a·b in eight partial sums, which vectorise.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    for (a, b) in a.chunks(8).zip(b.chunks(8)) {
        sums.iter_mut().zip(a.iter().zip(b)).for_each(|(sum, (a, b))| *sum += a * b);
    }
    sums.iter().sum()
}

/// Number of times that each of `batches` batches is drawn in a resample.
///
/// The numbers are those of SplitMix64 (Steele, Lea and Flood 2014) started at the number of the
/// resample times 2³²; the upper half of a word times the number of batches, over 2³², is uniform
/// up to 2⁻²⁴.
fn draw(resample: u64, batches: usize) -> Vec<f64> {
    let (mut words, mut times) = (SplitMix64::seed_from_u64(resample << 32), vec![0.0; batches]);
    for _ in 0..batches {
        times[(((words.next_u64() >> 32) * batches as u64) >> 32) as usize] += 1.0;
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
        fourth += elementary::powi(influence, 4);
    }
    let kurtosis: f64 = batches * fourth / (second * second);
    2.0 * batches / (kurtosis - 1.0).max(f64::EPSILON)
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::moments::BATCHES;

    fn draws(batches: usize) -> Vec<Vec<f64>> {
        (0..RESAMPLES as u64).map(|resample| draw(resample, batches)).collect()
    }

    #[test]
    fn batches_are_drawn_evenly_and_every_resample_is_another() {
        // A batch is drawn 399 times in all, with the standard deviation √399 = 20; five of them
        // are exceeded by one of 256 batches with probability 1.5e-4.
        let draws = draws(BATCHES);
        assert!(draws.iter().all(|times| times.iter().sum::<f64>() == BATCHES as f64));
        for batch in 0..BATCHES {
            let times: f64 = draws.iter().map(|times| times[batch]).sum();
            assert!((times - 399.0).abs() < 100.0, "{batch}: {times}");
        }
        assert!((1..RESAMPLES).all(|n| !draws[..n].contains(&draws[n])));
    }

    /// Skewed squares at two step sizes, which share a part.
    fn skewed(paths: u32) -> CrossMoments {
        CrossMoments::of((0..paths).map(|path| {
            let (shared, own) = (f64::from(path * path % 11), f64::from(path % 5));
            [1.0 + shared * shared, 3.0 + 0.5 * shared + own]
        }))
    }

    /// The ends of the interval by the steps 1 to 3 of this module, word for word.
    fn by_definition(squares: &CrossMoments, levels: &[usize], gain: &[f64]) -> (f64, f64) {
        let batches: Vec<(u64, &[f64])> = squares.batches().collect();
        let theta = |mean: &dyn Fn(usize) -> f64| -> f64 {
            levels.iter().zip(gain).map(|(&l, g)| g * mean(l).ln()).sum()
        };
        let estimate = theta(&|l| squares.mean(l));
        let draws = draws(batches.len());
        let statistic = |times: &Vec<f64>| {
            let over = |f: &dyn Fn(u64, &[f64]) -> f64| -> f64 {
                batches.iter().zip(times).map(|(&(n, x), times)| times * f(n, x)).sum()
            };
            let count = over(&|n, _| n as f64);
            let mean = |l: usize| over(&|_, x| x[l]) / count;
            let influence = |n: u64, x: &[f64]| -> f64 {
                levels.iter().zip(gain).map(|(&l, g)| g * (x[l] / mean(l) - n as f64)).sum()
            };
            let se = over(&|n, x| influence(n, x).powi(2)).sqrt() / count;
            (theta(&mean) - estimate) / se
        };
        let mut statistics: Vec<f64> = draws.iter().map(statistic).collect();
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
        let square = |path| [if path == 5 { 33.0 } else { 1.0 }, 2.0];
        let squares = CrossMoments::of((0..32).map(square));
        assert_eq!(reach(&squares, &[0], &[1.0]), None);
        // Nor has it ends where all squares are the same.
        assert_eq!(reach(&squares, &[1], &[1.0]), None);
    }
}
