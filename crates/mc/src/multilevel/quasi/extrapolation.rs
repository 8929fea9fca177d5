//! The limit τ → 0 from several levels, and a bound on what is left.
//!
//! With E_l = E[φ(y_l)], d_l = E_l − E_{l−1} and the weak order p, R_l = E_l + c·d_l with
//! c = 1/(2^p − 1) has no error of order p (Richardson; Talay and Tubaro 1990). R_L − R_{L−1} =
//! c(2^p d_L − d_{L−1}), and if what is left is of order p + 1 or more, as expansions in powers of
//! τ say, its size is at most b|R_L − R_{L−1}| and at most b2^{−p−1}|R_{L−1} − R_{L−2}| with
//! b = 1/(2^{p+1} − 1). The larger one is the bound: one alone may be small by chance.
//!
//! Where the differences are seen to fall by less than order p, there is no such expansion yet. c
//! then has the observed order, and the whole extrapolated part c|d_L| is the bound.

use real::elementary;

use super::super::{
    bias,
    plan::{LN_2, Term},
    report::Rate,
};

/// How far the observed order may significantly fall below the theoretical one.
const ORDER_TOLERANCE: f64 = 0.25;

/// The extrapolation of one test function.
pub struct Extrapolation {
    /// The order by which it is extrapolated.
    pub order: f64,
    /// c, the weight of the last difference beside one.
    pub weight: f64,
    /// The bound, without a statistical margin.
    pub size: f64,
    /// The standard error of the difference that makes it.
    pub standard_error: f64,
}

/// By the last three differences or fewer, the last one last, for a scheme of weak order
/// `weak_order`, where they fall by the order `alpha`.
pub fn extrapolation(differences: &[Term], weak_order: f64, alpha: Option<Rate>) -> Extrapolation {
    let order = bias::order(weak_order, alpha);
    let expands = order >= weak_order - ORDER_TOLERANCE;
    let order = if expands { weak_order } else { order };
    let power = elementary::exp(order * LN_2);
    let (weight, share) = (1.0 / (power - 1.0), 1.0 / (2.0 * power - 1.0));
    let variance = |term: &Term| term.variance / term.count;
    let change = |last: &Term, before: &Term| {
        let mean = weight * (power * last.mean - before.mean);
        let square = power * power * variance(last) + variance(before);
        (share * mean.abs(), share * weight * square.sqrt())
    };
    let whole = |last: &Term| (weight * last.mean.abs(), weight * variance(last).sqrt());
    let larger = |a: (f64, f64), b: (f64, f64)| if a.0 < b.0 { b } else { a };
    let (size, standard_error) = match differences {
        [.., last] if !expands => whole(last),
        [before, between, last] => {
            let (size, error) = change(between, before);
            larger(change(last, between), (0.5 * size / power, 0.5 * error / power))
        }
        [.., before, last] => change(last, before),
        _ => (f64::INFINITY, 0.0),
    };
    Extrapolation { order, weight, size, standard_error }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multilevel::tails::Tail;

    fn differences(error: impl Fn(f64) -> f64) -> (Vec<Term>, f64) {
        let at = |l: i32| error(f64::powi(0.5, l));
        let term =
            |mean: f64| Term { cost: 1.0, count: 1.0, mean, variance: 0.0, tail: Tail::default() };
        ((1..4).map(|l| term(at(l) - at(l - 1))).collect(), at(3))
    }

    #[test]
    fn the_bound_holds_what_extrapolation_leaves() {
        for (p, a, b) in [(2.0, 1.0, 0.5), (2.0, 1.0, -3.0), (2.0, 0.0, 1.0), (1.0, 2.0, -0.7)] {
            for q in [p + 1.0, p + 1.5, 2.0 * p] {
                let (terms, last) = differences(|tau| a * tau.powf(p) + b * tau.powf(q));
                let found = extrapolation(&terms, p, None);
                let left = last + found.weight * terms[2].mean;
                assert!(left.abs() <= found.size * (1.0 + 1e-9), "{p} {q}: {left}");
                // The first of higher order is met.
                assert!(q > p + 1.0 || left.abs() > 0.99 * found.size, "{p} {q}: {left}");
            }
            let (terms, last) = differences(|tau| a * tau.powf(p));
            let found = extrapolation(&terms, p, None);
            assert!((last + found.weight * terms[2].mean).abs() < 1e-14 && found.size < 1e-14);
        }
    }

    #[test]
    fn without_an_expansion_the_whole_is_the_bound() {
        let (terms, _) = differences(|tau| tau);
        let slow = Rate { value: 1.0, lower: 0.9, upper: 1.1 };
        let found = extrapolation(&terms, 2.0, Some(slow));
        let weight = 1.0 / (1.1f64.exp2() - 1.0);
        assert!((found.order - 1.1).abs() < 1e-15 && (found.weight - weight).abs() < 1e-14);
        assert!((found.size - weight / 8.0).abs() < 1e-14);
        let near = Rate { value: 1.7, lower: 1.5, upper: 1.9 };
        assert_eq!(extrapolation(&terms, 2.0, Some(near)).order, 2.0);
    }

    #[test]
    fn one_difference_bounds_nothing() {
        let (terms, _) = differences(|tau| tau);
        assert_eq!(extrapolation(&terms[..1], 1.0, None).size, f64::INFINITY);
        assert!(extrapolation(&terms[..2], 1.0, None).size < 1e-15);
    }
}
