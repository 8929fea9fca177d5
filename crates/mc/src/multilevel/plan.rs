//! Numbers of samples, bias, and the decay of means and variances: arithmetic on moments.

use std::f64::consts::LN_2;

use real::elementary;

use super::{
    level::{Samples, Values},
    report::{QUANTILE, Rate},
};

/// The part of the accuracy that may go to the bias: small, since halving the bias costs a level
/// where a level is cheap.
pub const BIAS_SHARE: f64 = 0.25;
/// Number of differences that bound the bias: one alone may be small by chance or by a change of
/// sign.
const BIAS_LEVELS: usize = 3;
/// The bias is extrapolated by no order below this.
const LOWEST_ORDER: f64 = 0.5;
/// Differences of this many standard errors have a logarithm that is nearly normal.
const SIGNIFICANT: f64 = 4.0;

/// The bias of one test function.
pub struct Bias {
    /// The signed estimate from the last difference.
    pub value: f64,
    /// The largest estimate from the last differences, without a margin.
    pub size: f64,
    /// The largest with 1.96 standard errors added.
    pub bound: f64,
}

fn exp2(x: f64) -> f64 {
    elementary::exp(x * LN_2)
}

fn log2(x: f64) -> f64 {
    elementary::ln(x) / LN_2
}

/// The order by which the bias is extrapolated: the one given, or the upper end of the observed one
/// if that is less.
fn order(given: f64, alpha: Option<Rate>) -> f64 {
    alpha.map_or(given, |alpha| given.min(alpha.upper).max(given.min(LOWEST_ORDER)))
}

/// Factor from the difference of a level, `below` levels under the last, to the bias on the last.
fn extrapolation(order: f64, below: usize) -> f64 {
    exp2(-order * below as f64) / (exp2(order) - 1.0)
}

/// The last differences, from the last down, each with its [`extrapolation`].
fn extrapolated(
    differences: &[Samples],
    k: usize,
    weak_order: f64,
) -> impl Iterator<Item = (&Samples, f64)> {
    let order = order(weak_order, alpha(differences, k));
    let last = differences.iter().rev().take(BIAS_LEVELS).enumerate();
    last.map(move |(below, samples)| (samples, extrapolation(order, below)))
}

/// The bias of test function number k on the level of the last difference.
pub fn bias(differences: &[Samples], k: usize, weak_order: f64) -> Bias {
    let mut last = None;
    let (mut size, mut bound) = (0.0, 0.0);
    for (samples, factor) in extrapolated(differences, k, weak_order) {
        let sample = &samples.values[k].sample;
        let (mean, error) = (sample.mean(), sample.variance_of_mean().sqrt());
        last.get_or_insert(factor * mean);
        size = f64::max(size, factor * mean.abs());
        bound = f64::max(bound, factor * (mean.abs() + QUANTILE * error));
    }
    Bias { value: last.unwrap_or(0.0), size, bound }
}

/// Raises the samples of the last differences until their margin in the bias of test function
/// number k is at most `margin`.
pub fn raise_for_bias(
    wanted: &mut [u64],
    differences: &[Samples],
    k: usize,
    weak_order: f64,
    margin: f64,
) {
    let last = extrapolated(differences, k, weak_order);
    for (wanted, (samples, factor)) in wanted.iter_mut().rev().zip(last) {
        let quotient = QUANTILE * factor / margin;
        let n = samples.values[k].sample.variance() * quotient * quotient;
        *wanted = (*wanted).max(n.ceil() as u64);
    }
}

/// Squared standard error of the sum of the level means.
pub fn variance_of_sum(levels: &[Samples], k: usize) -> f64 {
    levels.iter().map(|samples| samples.values[k].sample.variance_of_mean()).sum()
}

/// Samples of each level with which every test function k reaches the half-width `half_widths[k]`
/// at the least cost for it alone: N_l = (1.96/half-width)²·√(V_l/C_l)·Σ_j √(V_jC_j) (Giles 2008),
/// and the largest over k.
pub fn samples(levels: &[(f64, Vec<f64>)], half_widths: &[f64]) -> Vec<u64> {
    let mut wanted = vec![0; levels.len()];
    for (k, half_width) in half_widths.iter().enumerate() {
        let quotient = QUANTILE / half_width;
        let sum: f64 = levels.iter().map(|(cost, variances)| (variances[k] * cost).sqrt()).sum();
        for (wanted, (cost, variances)) in wanted.iter_mut().zip(levels) {
            let n = quotient * quotient * (variances[k] / cost).sqrt() * sum;
            *wanted = n.ceil().max(*wanted as f64) as u64;
        }
    }
    wanted
}

/// Costs and variances of levels.
pub fn costs_and_variances(levels: &[Samples]) -> Vec<(f64, Vec<f64>)> {
    let of_level = |Samples { cost_per_path, values, .. }: &Samples| {
        let variances = values.iter().map(|values| values.sample.variance());
        (*cost_per_path as f64, variances.collect())
    };
    levels.iter().map(of_level).collect()
}

/// Expected cost and variances of the next level: twice the cost, and variances that fall by the
/// last ratio, if that is from one to four.
pub fn next_level(levels: &[Samples]) -> (f64, Vec<f64>) {
    let [.., before, last] = levels else { unreachable!("there are at least three levels") };
    let fall = |(before, last): (&Values, &Values)| {
        let (v0, v1) = (before.sample.variance(), last.sample.variance());
        if v0 > 0.0 { v1 * (v1 / v0).clamp(0.25, 1.0) } else { v1 }
    };
    (2.0 * last.cost_per_path as f64, before.values.iter().zip(&last.values).map(fall).collect())
}

/// How fast the means of the differences fall.
pub fn alpha(differences: &[Samples], k: usize) -> Option<Rate> {
    let points = differences.iter().filter_map(|samples| {
        let sample = &samples.values[k].sample;
        let (size, error) = (sample.mean().abs(), sample.variance_of_mean().sqrt());
        let relative = error / (size * LN_2);
        (samples.values[k].varies() && size > SIGNIFICANT * error)
            .then(|| (samples.level, log2(size), relative * relative))
    });
    decay(&points.collect::<Vec<_>>())
}

/// How fast the variances of the differences fall. The relative variance of a sample variance is
/// (kurtosis − 1)/N.
pub fn beta(differences: &[Samples], k: usize) -> Option<Rate> {
    let points = differences.iter().filter_map(|samples| {
        let (values, n) = (&samples.values[k], samples.count() as f64);
        // At least one of two equally frequent values has kurtosis one; its variance is known to
        // 1/N.
        let relative = (values.sample.kurtosis() - 1.0 + 1.0 / n) / n;
        let variance = relative / (LN_2 * LN_2);
        values.varies().then(|| (samples.level, log2(values.sample.variance()), variance))
    });
    decay(&points.collect::<Vec<_>>())
}

/// Weighted least squares for minus the slope of (level, logarithm, variance of it). If the points
/// are not on a line, the interval is widened by √(χ²/(n − 2)) > 1.
fn decay(points: &[(usize, f64, f64)]) -> Option<Rate> {
    if points.len() < 2 {
        return None;
    }
    let sum = |f: &dyn Fn(f64, f64) -> f64| {
        points.iter().map(|&(l, y, variance)| f(l as f64, y) / variance).sum::<f64>()
    };
    let weight = sum(&|_, _| 1.0);
    let (x_mean, y_mean) = (sum(&|x, _| x) / weight, sum(&|_, y| y) / weight);
    let spread = sum(&|x, _| (x - x_mean) * (x - x_mean));
    let slope = sum(&|x, y| (x - x_mean) * (y - y_mean)) / spread;
    let residual = |x: f64, y: f64| y - y_mean - slope * (x - x_mean);
    let excess = match points.len() - 2 {
        0 => 1.0,
        freedom => f64::max(sum(&|x, y| residual(x, y) * residual(x, y)) / freedom as f64, 1.0),
    };
    let half_width = QUANTILE * (excess / spread).sqrt();
    Some(Rate { value: -slope, lower: -slope - half_width, upper: -slope + half_width })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_and_a_bend_widens_it() {
        let line: Vec<_> = (1..5usize).map(|l| (l, 3.0 - 1.5 * l as f64, 0.01)).collect();
        let rate = decay(&line).unwrap();
        assert!((rate.value - 1.5).abs() < 1e-12);
        // Σ(x − x̄)² = 5 with weights 100.
        assert!((rate.upper - rate.value - QUANTILE / 500f64.sqrt()).abs() < 1e-12);
        let bent: Vec<_> =
            line.iter().map(|&(l, y, v)| (l, y + if l == 2 { 1.0 } else { 0.0 }, v)).collect();
        let bent = decay(&bent).unwrap();
        assert!(bent.upper - bent.lower > 3.0 * (rate.upper - rate.lower));
        assert_eq!(decay(&line[..1]), None);
    }

    #[test]
    fn samples_reach_the_half_width_at_least_cost() {
        let levels = [(4.0, vec![1.0, 1e-6]), (20.0, vec![0.04, 1e-6]), (40.0, vec![0.01, 1e-6])];
        let half_widths = [0.01, 0.01];
        let wanted = samples(&levels, &half_widths);
        let variance = |n: &[f64]| levels.iter().zip(n).map(|((_, v), n)| v[0] / n).sum::<f64>();
        let cost = |n: &[f64]| levels.iter().zip(n).map(|((c, _), n)| c * n).sum::<f64>();
        let best: Vec<f64> = wanted.iter().map(|&n| n as f64).collect();
        let reached = QUANTILE * variance(&best).sqrt();
        assert!(reached <= 0.01 && reached > 0.01 * (1.0 - 1e-3));
        // Any other split with the same variance costs more.
        for (moved, other) in [(0, 1), (1, 2), (2, 0)] {
            let mut n = best.clone();
            n[moved] *= 1.1;
            let missing = variance(&best) - (variance(&n) - levels[other].1[0] / n[other]);
            n[other] = levels[other].1[0] / missing;
            assert!(cost(&n) > cost(&best) * (1.0 + 1e-6), "{moved} {other}");
        }
    }

    #[test]
    fn the_order_of_extrapolation_is_the_given_one_unless_contradicted() {
        let rate = |lower, upper| Some(Rate { value: 0.5 * (lower + upper), lower, upper });
        assert_eq!(order(1.0, None), 1.0);
        assert_eq!(order(1.0, rate(0.9, 1.2)), 1.0);
        assert_eq!(order(1.0, rate(1.9, 2.2)), 1.0);
        assert_eq!(order(1.0, rate(0.6, 0.8)), 0.8);
        assert_eq!(order(1.0, rate(-0.1, 0.1)), 0.5);
        assert_eq!(order(0.4, rate(-0.1, 0.1)), 0.4);
        assert!((extrapolation(1.0, 2) - 0.25).abs() < 1e-15);
    }
}
