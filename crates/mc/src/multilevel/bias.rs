//! The bias on the last level, from the differences.
//!
//! E[φ(y(T))] − E[φ(y_τ)] = Aτ^p + Bτ^{p+1} is assumed, with the weak order p. Differences d_l =
//! E[φ(y_l) − φ(y_{l−1})] of the last levels l ≤ L give it in four ways, each a sum Σ w_l d_l: from
//! one difference, 2^{−p(L−l)}d_l/(2^p − 1) with l = L, L − 1 and L − 2, right where B = 0; and
//! from two, u/(2^p − 1) + v/(2^{p+1} − 1) with v = (d_{L−1} − 2^p d_L)/2^p and u = d_L − v, right
//! for any B. The largest bounds the bias: a difference may be small where A and B nearly cancel.

use real::elementary;

use super::{
    plan::{LN_2, Term, half_width},
    report::{QUANTILE, Rate},
};

/// Number of differences that bound the bias.
pub const BIAS_LEVELS: usize = 3;
/// The bias is extrapolated by no order below this, nor below half of the one given.
const LOWEST_ORDER: f64 = 0.5;

/// Weights of the last differences, from the last down.
type Weights = [f64; BIAS_LEVELS];

/// The bias of one test function.
pub struct Bias {
    /// The signed estimate from the last difference.
    pub value: f64,
    /// The largest estimate, without a margin.
    pub size: f64,
    /// The largest with its half-width added, from standard errors and tails.
    pub bound: f64,
}

/// The order by which the bias is extrapolated: the one given, or the upper end of the observed one
/// if that is less.
pub fn order(given: f64, alpha: Option<Rate>) -> f64 {
    alpha.map_or(given, |alpha| given.min(alpha.upper).max(lowest(given)))
}

/// The least order that is believed: a lower one is not what the extrapolation assumes.
pub fn lowest(given: f64) -> f64 {
    LOWEST_ORDER.min(0.5 * given)
}

/// The four estimates for the order p.
fn estimates(p: f64) -> [Weights; 4] {
    let power = |x: f64| elementary::exp(x * LN_2);
    let (first, second) = (1.0 / (power(p) - 1.0), 1.0 / (power(p + 1.0) - 1.0));
    // d_L and d_{L−1} in v.
    let (last, before) = (-1.0, power(-p));
    [
        [first, 0.0, 0.0],
        [0.0, first * power(-p), 0.0],
        [0.0, 0.0, first * power(-2.0 * p)],
        [first + last * (second - first), before * (second - first), 0.0],
    ]
}

/// The bias on the level of the last difference for the order p.
pub fn bias(differences: &[Term], p: f64) -> Bias {
    let [last, ..] = estimates(p);
    let value = differences.last().map_or(0.0, |term| last[0] * term.mean);
    let (mut size, mut bound) = (0.0, 0.0);
    for weights in estimates(p) {
        let (mut mean, mut variance, mut tail) = (0.0, 0.0, 0.0);
        for (term, weight) in differences.iter().rev().zip(weights) {
            mean += weight * term.mean;
            variance += weight * weight * term.variance / term.count;
            let part = weight * term.tail.size / term.count;
            tail += part * part;
        }
        size = f64::max(size, mean.abs());
        bound = f64::max(bound, mean.abs() + half_width(variance, tail.sqrt()));
    }
    Bias { value, size, bound }
}

/// Raises the samples of the last differences until the margin of every estimate of the bias is at
/// most `margin`.
pub fn raise(wanted: &mut [u64], differences: &[Term], p: f64, margin: f64) {
    for weights in estimates(p) {
        let used = || differences.iter().rev().zip(weights).filter(|(_, weight)| *weight != 0.0);
        let tailed = used().any(|(term, _)| term.tail.size > 0.0);
        // The squares of this many margins add up.
        let parts = used().count() * if tailed { 2 } else { 1 };
        let margin = margin / (parts as f64).sqrt();
        let last = differences.iter().rev().zip(weights).zip(wanted.iter_mut().rev());
        for ((term, weight), wanted) in last {
            let quotient = QUANTILE * weight / margin;
            let normal = term.variance * quotient * quotient;
            let tail = weight.abs() * term.tail.size / margin;
            *wanted = normal.max(tail.min(term.tail.enough)).ceil().max(*wanted as f64) as u64;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multilevel::tails::Tail;

    fn term(mean: f64) -> Term {
        Term { cost: 1.0, count: 1e6, mean, variance: 0.0, tail: Tail::default() }
    }

    /// d_1, …, d_L for e(τ) = Aτ^p + Bτ^{p+1}, τ = 2^{−l}, and e on level L.
    fn expansion(a: f64, b: f64, p: f64, last: i32) -> (Vec<Term>, f64) {
        let e =
            |l: i32| a * 2f64.powf(-p * f64::from(l)) + b * 2f64.powf(-(p + 1.0) * f64::from(l));
        ((1..=last).map(|l| term(e(l - 1) - e(l))).collect(), e(last))
    }

    #[test]
    fn two_terms_are_bounded_where_differences_nearly_cancel() {
        let mut understated = 0.0;
        for p in [0.5, 1.0, 1.5, 2.0] {
            for last in [3, 5] {
                for n in -400..400 {
                    let (d, e) = expansion(1.0, 0.05 * f64::from(n), p, last);
                    let found = bias(&d, p);
                    assert!(found.bound >= e.abs() * (1.0 - 1e-12), "{n} {p}: {} {e}", found.bound);
                    // The rule before: the largest of the estimates from one difference.
                    let one = d.iter().rev().zip([1.0, 2f64.powf(-p), 4f64.powf(-p)]);
                    let one = one.map(|(d, w)| w * d.mean.abs()).fold(0.0, f64::max);
                    understated = f64::max(understated, e.abs() * (2f64.powf(p) - 1.0) / one);
                }
            }
        }
        assert!(understated > 1.4, "{understated}");
    }

    #[test]
    fn consistent_differences_are_bounded_as_by_one_of_them() {
        let (d, e) = expansion(0.3, 0.0, 1.0, 4);
        let found = bias(&d, 1.0);
        assert!((found.bound - e).abs() < 1e-15 && (found.value - e).abs() < 1e-15);
        // p = 1: (5d_L − d_{L−1})/3.
        let [.., two] = estimates(1.0);
        assert!((two[0] - 5.0 / 3.0).abs() < 1e-15 && (two[1] + 1.0 / 3.0).abs() < 1e-15);
    }

    #[test]
    fn raised_samples_keep_the_margin() {
        let tail = Tail { size: 2.0, enough: 1e9 };
        let d: Vec<Term> = (0..3).map(|_| Term { variance: 0.3, tail, ..term(0.0) }).collect();
        let mut wanted = [0; 3];
        raise(&mut wanted, &d, 1.0, 1e-3);
        let raised: Vec<Term> =
            d.iter().zip(wanted).map(|(term, n)| Term { count: n as f64, ..*term }).collect();
        let bound = bias(&raised, 1.0).bound;
        assert!(bound <= 1e-3 && bound > 0.5e-3, "{bound}");
    }

    #[test]
    fn the_order_of_extrapolation_is_the_given_one_unless_contradicted() {
        let rate = |lower, upper| Some(Rate { value: 0.5 * (lower + upper), lower, upper });
        assert_eq!(order(1.0, None), 1.0);
        assert_eq!(order(1.0, rate(0.9, 1.2)), 1.0);
        assert_eq!(order(1.0, rate(1.9, 2.2)), 1.0);
        assert_eq!(order(1.0, rate(0.6, 0.8)), 0.8);
        assert_eq!(order(1.0, rate(-0.1, 0.1)), 0.5);
        assert_eq!(order(0.4, rate(-0.1, 0.1)), 0.2);
    }
}
