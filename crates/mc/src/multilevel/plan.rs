//! How many samples each level needs, what the bias is, and how fast means and variances decay:
//! arithmetic on moments, without a clock and without a random number.

use real::elementary;

use super::level::{Row, Values};
use super::{Estimate, Rate};

/// P(|N(0, 1)| ≤ this) = 95 %.
pub(crate) const QUANTILE: f64 = 1.959_963_984_540_054;
/// The part of the accuracy that may go to the bias: small, since halving the bias costs a level
/// where a level is cheap.
pub(crate) const BIAS_SHARE: f64 = 0.25;
/// The differences that the bias is judged by: one alone may be small by chance or by a change of
/// sign.
pub(crate) const BIAS_LEVELS: usize = 3;
/// The bias is extrapolated by no order below this.
const LOWEST_ORDER: f64 = 0.5;
/// Differences of this many standard errors have a logarithm that is near normal.
const SIGNIFICANT: f64 = 4.0;

/// The bias of one test function.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bias {
    /// The signed estimate from the last difference.
    pub(crate) value: f64,
    /// The largest estimate from the last differences, without a margin.
    pub(crate) size: f64,
    /// The largest with 1.96 standard errors added.
    pub(crate) bound: f64,
}

/// 2^x.
fn exp2(x: f64) -> f64 {
    elementary::exp(x * std::f64::consts::LN_2)
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

/// The bias of test function number k on the level of the last difference.
pub(crate) fn bias(differences: &[Row], k: usize, weak_order: f64) -> Bias {
    let order = order(weak_order, alpha(differences, k));
    let mut bias = Bias { value: 0.0, size: 0.0, bound: 0.0 };
    for (below, row) in differences.iter().rev().take(BIAS_LEVELS).enumerate() {
        let (sample, factor) = (&row.values[k].sample, extrapolation(order, below));
        if below == 0 {
            bias.value = factor * sample.mean();
        }
        bias.size = bias.size.max(factor * sample.mean().abs());
        bias.bound = bias
            .bound
            .max(factor * (sample.mean().abs() + QUANTILE * sample.variance_of_mean().sqrt()));
    }
    bias
}

/// Samples of each of the last differences whose margin in the bias is at most `margin`, zero for
/// the others.
pub(crate) fn samples_for_bias(
    differences: &[Row],
    k: usize,
    weak_order: f64,
    margin: f64,
) -> Vec<u64> {
    let order = order(weak_order, alpha(differences, k));
    let last = differences.len();
    let wanted = |(l, row): (usize, &Row)| {
        let below = last - 1 - l;
        if below >= BIAS_LEVELS {
            return 0;
        }
        let quotient = QUANTILE * extrapolation(order, below) / margin;
        (row.values[k].sample.variance() * quotient * quotient).ceil() as u64
    };
    differences.iter().enumerate().map(wanted).collect()
}

/// Squared standard error of the sum of the level means.
pub(crate) fn variance_of_sum(rows: &[Row], k: usize) -> f64 {
    rows.iter().map(|row| row.values[k].sample.variance_of_mean()).sum()
}

/// Samples of each level with which every test function k reaches the half-width `half_widths[k]`
/// at the least cost for it alone: N_l = (1.96/half-width)²·√(V_l/C_l)·Σ_j √(V_jC_j) (Giles 2008),
/// and the largest over k.
pub(crate) fn samples(levels: &[(u64, Vec<f64>)], half_widths: &[f64]) -> Vec<u64> {
    let mut wanted = vec![0; levels.len()];
    for (k, half_width) in half_widths.iter().enumerate() {
        let quotient = QUANTILE / half_width;
        let sum: f64 =
            levels.iter().map(|(cost, variances)| (variances[k] * *cost as f64).sqrt()).sum();
        for (wanted, (cost, variances)) in wanted.iter_mut().zip(levels) {
            let n = quotient * quotient * (variances[k] / *cost as f64).sqrt() * sum;
            *wanted = n.ceil().max(*wanted as f64) as u64;
        }
    }
    wanted
}

/// Costs and variances of levels.
pub(crate) fn costs_and_variances(rows: &[Row]) -> Vec<(u64, Vec<f64>)> {
    let variances = |row: &Row| row.values.iter().map(|values| values.sample.variance()).collect();
    rows.iter().map(|row| (row.cost_per_path, variances(row))).collect()
}

/// What the next level will be like: twice the cost, and variances that fall as they did last, by
/// one to four times.
pub(crate) fn next_level(rows: &[Row]) -> (u64, Vec<f64>) {
    let [.., before, last] = rows else { unreachable!("there are at least three levels") };
    let fall = |(before, last): (&Values, &Values)| {
        let (v0, v1) = (before.sample.variance(), last.sample.variance());
        if v0 > 0.0 { v1 * (v1 / v0).clamp(0.25, 1.0) } else { v1 }
    };
    (2 * last.cost_per_path, before.values.iter().zip(&last.values).map(fall).collect())
}

/// How fast the means of the differences fall.
pub(crate) fn alpha(differences: &[Row], k: usize) -> Option<Rate> {
    let points = differences.iter().filter_map(|row| {
        let sample = &row.values[k].sample;
        let (size, error) = (sample.mean().abs(), sample.variance_of_mean().sqrt());
        let relative = error / (size * std::f64::consts::LN_2);
        (row.values[k].varies() && size > SIGNIFICANT * error)
            .then(|| (row.level, log2(size), relative * relative))
    });
    decay(&points.collect::<Vec<_>>())
}

/// How fast the variances of the differences fall. The relative variance of a sample variance is
/// (kurtosis − 1)/N.
pub(crate) fn beta(differences: &[Row], k: usize) -> Option<Rate> {
    let points = differences.iter().filter_map(|row| {
        let (values, n) = (&row.values[k], row.samples() as f64);
        // At least one of two equally frequent values has kurtosis one; its variance is known to
        // 1/N.
        let relative = (values.sample.kurtosis() - 1.0 + 1.0 / n) / n;
        let variance = relative / (std::f64::consts::LN_2 * std::f64::consts::LN_2);
        values.varies().then(|| (row.level, log2(values.sample.variance()), variance))
    });
    decay(&points.collect::<Vec<_>>())
}

fn log2(x: f64) -> f64 {
    elementary::ln(x) / std::f64::consts::LN_2
}

/// Weighted least squares for minus the slope of (level, logarithm, variance of it). The interval
/// is widened by √(χ²/(n − 2)) where that exceeds one, that is where the points are not on a line.
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

/// The estimate of test function number k from the rows that add up to it and the differences that
/// show its bias.
pub(crate) fn estimate(
    name: &'static str,
    terms: &[Row],
    differences: &[Row],
    k: usize,
    weak_order: f64,
) -> Estimate {
    let bias = bias(differences, k, weak_order);
    Estimate {
        name,
        value: terms.iter().map(|row| row.values[k].sample.mean()).sum(),
        standard_error: variance_of_sum(terms, k).sqrt(),
        bias: bias.value,
        bias_bound: bias.bound,
        alpha: alpha(differences, k),
        beta: beta(differences, k),
    }
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
        let levels = [(4, vec![1.0, 1e-6]), (20, vec![0.04, 1e-6]), (40, vec![0.01, 1e-6])];
        let half_widths = [0.01, 0.01];
        let wanted = samples(&levels, &half_widths);
        let variance = |n: &[f64]| levels.iter().zip(n).map(|((_, v), n)| v[0] / n).sum::<f64>();
        let cost = |n: &[f64]| levels.iter().zip(n).map(|((c, _), n)| *c as f64 * n).sum::<f64>();
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
