//! Numbers of samples, and the decay of means and variances: arithmetic on moments.

pub use std::f64::consts::LN_2;

use real::elementary;

use super::{
    level::Samples,
    report::{QUANTILE, Rate},
    tails::{Tail, tails},
};

/// The part of the accuracy that may go to the bias: small, since halving the bias costs a level
/// where a level is cheap.
pub const BIAS_SHARE: f64 = 0.25;
/// Differences of this many standard errors have a logarithm that is nearly normal.
pub const SIGNIFICANT: f64 = 4.0;
/// Halvings of an interval until it has the width of rounding errors.
const HALVINGS: usize = 52;

/// One test function on one level.
#[derive(Clone, Copy, Debug)]
pub struct Term {
    /// Path-steps of a sample.
    pub cost: f64,
    /// Number of samples.
    pub count: f64,
    /// Their mean.
    pub mean: f64,
    /// Their variance.
    pub variance: f64,
    /// What they may have missed.
    pub tail: Tail,
}

/// Test function number k on each of these levels, where φ spreads by `range` on all.
pub fn terms(levels: &[Samples], k: usize, range: f64) -> Vec<Term> {
    let term = |(samples, tail): (&Samples, Tail)| {
        let sample = &samples.values[k].sample;
        let (cost, count) = (samples.cost_per_path as f64, samples.count() as f64);
        Term { cost, count, mean: sample.mean(), variance: sample.variance(), tail }
    };
    levels.iter().zip(tails(levels, k, range)).map(term).collect()
}

/// Squared standard error of the sum of the means.
pub fn variance_of_sum(terms: &[Term]) -> f64 {
    terms.iter().map(|term| term.variance / term.count).sum()
}

/// What missed events may add to the sum of the means: the root of the sum of squares, since the
/// events of the levels are independent.
pub fn tail_of_sum(terms: &[Term]) -> f64 {
    let square = |term: &Term| (term.tail.size / term.count) * (term.tail.size / term.count);
    terms.iter().map(square).sum::<f64>().sqrt()
}

/// Half-width of the 95 % interval of a mean with this squared standard error.
pub fn half_width(variance: f64, tail: f64) -> f64 {
    (QUANTILE * QUANTILE * variance + tail * tail).sqrt()
}

/// Raises the samples of each level to those with which the sum reaches the half-width h.
///
/// Standard errors get the part x of it, N_l = (1.96/x)²·√(V_l/C_l)·Σ_j √(V_jC_j), which costs
/// least (Giles 2008). Tails P_l get √(h² − x²), N_l = √(P_l/C_l)·√(Σ_j P_jC_j)/√(h² − x²), but no
/// more than [`Tail::enough`]. The sum of both costs is least for x.
pub fn raise(wanted: &mut [u64], terms: &[Term], h: f64) {
    let sum = |of: fn(&Term) -> f64| terms.iter().map(of).sum::<f64>();
    let normal = QUANTILE * sum(|term| (term.variance * term.cost).sqrt());
    let tail = sum(|term| term.tail.size * term.cost).sqrt();
    let x = normal_part(normal, tail * sum(|term| (term.tail.size * term.cost).sqrt()), h);
    for (wanted, term) in wanted.iter_mut().zip(terms) {
        let n = QUANTILE * normal * (term.variance / term.cost).sqrt() / (x * x);
        let tailed = match term.tail.size {
            0.0 => 0.0,
            size => tail * (size / term.cost).sqrt() / (h * h - x * x).sqrt(),
        };
        *wanted = n.max(tailed.min(term.tail.enough)).ceil().max(*wanted as f64) as u64;
    }
}

/// The x from 0 to h where a²/x² + b/√(h² − x²) is least.
fn normal_part(a: f64, b: f64, h: f64) -> f64 {
    if b == 0.0 {
        return h;
    }
    let (mut lower, mut upper) = (0.0, h);
    for _ in 0..HALVINGS {
        let x = 0.5 * (lower + upper);
        let rest = h * h - x * x;
        let falls = 2.0 * a * a * rest * rest.sqrt() > b * x * x * x * x;
        *if falls { &mut lower } else { &mut upper } = x;
    }
    lower
}

/// What is expected of the next level: twice the cost, and a variance that falls by the last ratio,
/// if that is from one to four.
pub fn next_level(terms: &[Term]) -> Term {
    let [.., before, last] = terms else { unreachable!("there are at least three levels") };
    let fall = last.variance / before.variance;
    let fall = if before.variance > 0.0 { fall.clamp(0.25, 1.0) } else { 1.0 };
    Term { cost: 2.0 * last.cost, variance: last.variance * fall, ..*last }
}

/// How fast the means of the differences fall, if all that are significant have one sign.
pub fn alpha(differences: &[Samples], terms: &[Term], k: usize) -> Option<Rate> {
    let significant = differences.iter().zip(terms).filter(|(samples, term)| {
        let error = (term.variance / term.count).sqrt();
        let margin = SIGNIFICANT * error + term.tail.size / term.count;
        samples.values[k].varies() && term.mean.abs() > margin
    });
    let significant: Vec<_> = significant.collect();
    let positive = significant.iter().filter(|(_, term)| term.mean > 0.0).count();
    if positive != 0 && positive != significant.len() {
        return None;
    }
    let point = |(samples, term): &(&Samples, &Term)| {
        let relative = term.variance / (term.count * term.mean * term.mean * LN_2 * LN_2);
        (samples.level, log2(term.mean.abs()), relative)
    };
    decay(&significant.iter().map(point).collect::<Vec<_>>())
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

fn log2(x: f64) -> f64 {
    elementary::ln(x) / LN_2
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
    use crate::multilevel::{level::Values, resolution::Motion, settings::Coupling};

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
    fn no_rate_is_named_where_significant_signs_differ() {
        let difference = |level: usize, mean: f64| {
            let mut values = Values::default();
            (0..1000).for_each(|n| values.sample.add(mean + 0.01 * f64::from(n % 2)));
            let motion = Motion::default();
            let (values, coupling) = (vec![values], Some(Coupling::Plain));
            let paths = 1000;
            Samples { level, coupling, cost_per_path: 1, values, motion, paths, failed: 0 }
        };
        let rate = |means: [f64; 3]| {
            let levels: Vec<_> = (1..).zip(means).map(|(l, mean)| difference(l, mean)).collect();
            alpha(&levels, &terms(&levels, 0, 1.0), 0)
        };
        assert!(rate([0.4, 0.2, 0.1]).is_some());
        // |d_l| alone falls as well.
        assert_eq!(rate([0.4, -0.2, 0.1]), None);
    }

    /// Terms of (cost, variance, size of the tail).
    fn levels(of: [(f64, f64, f64); 3]) -> Vec<Term> {
        let term = |(cost, variance, size)| {
            let tail = Tail { size, enough: f64::INFINITY };
            Term { cost, count: 1.0, mean: 0.0, variance, tail }
        };
        of.map(term).to_vec()
    }

    fn reached(terms: &[Term]) -> f64 {
        half_width(variance_of_sum(terms), tail_of_sum(terms))
    }

    fn with_samples(terms: &[Term], wanted: &[u64]) -> Vec<Term> {
        let counts = terms.iter().zip(wanted);
        counts.map(|(term, &n)| Term { count: n.max(1) as f64, ..*term }).collect()
    }

    #[test]
    fn samples_reach_the_half_width_at_least_cost() {
        let terms = levels([(4.0, 1.0, 0.0), (20.0, 0.04, 0.0), (40.0, 0.01, 0.0)]);
        let mut wanted = [0; 3];
        raise(&mut wanted, &levels([(4.0, 1e-6, 0.0), (20.0, 1e-6, 0.0), (40.0, 1e-6, 0.0)]), 0.01);
        raise(&mut wanted, &terms, 0.01);
        let reached = reached(&with_samples(&terms, &wanted));
        assert!(reached <= 0.01 && reached > 0.01 * (1.0 - 1e-3));
        let variance =
            |n: &[f64]| terms.iter().zip(n).map(|(term, n)| term.variance / n).sum::<f64>();
        let cost = |n: &[f64]| terms.iter().zip(n).map(|(term, n)| term.cost * n).sum::<f64>();
        let best: Vec<f64> = wanted.iter().map(|&n| n as f64).collect();
        // Any other split with the same variance costs more.
        for (moved, other) in [(0, 1), (1, 2), (2, 0)] {
            let mut n = best.clone();
            n[moved] *= 1.1;
            let missing = variance(&best) - (variance(&n) - terms[other].variance / n[other]);
            n[other] = terms[other].variance / missing;
            assert!(cost(&n) > cost(&best) * (1.0 + 1e-6), "{moved} {other}");
        }
    }

    #[test]
    fn samples_bring_tails_into_the_half_width() {
        for (tail, variance) in [(3.0, 1.0), (3.0, 0.0), (0.01, 1.0), (100.0, 1.0)] {
            let terms = levels([(4.0, variance, 0.0), (20.0, 0.04, tail), (40.0, 0.0, tail)]);
            let mut wanted = [0; 3];
            raise(&mut wanted, &terms, 0.01);
            let reached = reached(&with_samples(&terms, &wanted));
            // Each level has the larger of two numbers: at most twice what both need.
            assert!(reached <= 0.01 && reached > 0.005, "{tail} {variance}: {reached}");
        }
        // No more samples than end the tail.
        let mut terms = levels([(4.0, 0.0, 1.0), (20.0, 0.0, 0.0), (40.0, 0.0, 0.0)]);
        terms[0].tail.enough = 50.0;
        let mut wanted = [0; 3];
        raise(&mut wanted, &terms, 1e-3);
        assert_eq!(wanted, [50, 0, 0]);
    }
}
