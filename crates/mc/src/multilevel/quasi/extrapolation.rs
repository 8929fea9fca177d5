//! The limit τ → 0 from several levels, and a bound on what is left.
//!
//! With E_l = E[φ(y_l)], d_l = E_l − E_{l−1} and the weak order p, R_l = E_l + c·d_l with
//! c = 1/(2^p − 1) has no error of order p (Richardson; Talay and Tubaro 1990). R_L − R_{L−1} =
//! c(2^p d_L − d_{L−1}), and if what is left is of order p + 1 or more, as expansions in powers of
//! τ say, its size is at most b|R_L − R_{L−1}| and at most b2^{−p−1}|R_{L−1} − R_{L−2}| with
//! b = 1/(2^{p+1} − 1). The larger one is the bound: one alone may be small by chance.

use real::elementary;

use super::super::plan::{LN_2, Term};

/// The extrapolation of one test function.
pub struct Extrapolation {
    /// c, the weight of the last difference beside one.
    pub weight: f64,
    /// The bound, without a statistical margin.
    pub size: f64,
    /// The standard error of the difference that makes it.
    pub standard_error: f64,
}

/// By the last three differences or fewer, the last one last, for the order p.
pub fn extrapolation(differences: &[Term], p: f64) -> Extrapolation {
    let power = elementary::exp(p * LN_2);
    let (weight, share) = (1.0 / (power - 1.0), 1.0 / (2.0 * power - 1.0));
    let change = |last: &Term, before: &Term| {
        let variance = |term: &Term| term.variance / term.count;
        let mean = weight * (power * last.mean - before.mean);
        let square = power * power * variance(last) + variance(before);
        (share * mean.abs(), share * weight * square.sqrt())
    };
    let (size, standard_error) = match differences {
        [.., before, between, last] => {
            let (late, early) = (change(last, between), change(between, before));
            let early = (0.5 * early.0 / power, 0.5 * early.1 / power);
            if early.0 > late.0 { early } else { late }
        }
        [before, last] => change(last, before),
        _ => (f64::INFINITY, 0.0),
    };
    Extrapolation { weight, size, standard_error }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multilevel::tails::Tail;

    fn differences(error: impl Fn(f64) -> f64) -> (Vec<Term>, f64) {
        let at = |l: i32| error(f64::powi(0.5, l));
        let term = |mean: f64| {
            Term { cost: 1.0, count: 1.0, mean, variance: 0.0, tail: Tail::default() }
        };
        ((1..4).map(|l| term(at(l) - at(l - 1))).collect(), at(3))
    }

    #[test]
    fn the_bound_holds_what_extrapolation_leaves() {
        for (p, a, b) in [(2.0, 1.0, 0.5), (2.0, 1.0, -3.0), (2.0, 0.0, 1.0), (1.0, 2.0, -0.7)] {
            for q in [p + 1.0, p + 1.5, 2.0 * p] {
                let (terms, last) = differences(|tau| a * tau.powf(p) + b * tau.powf(q));
                let found = extrapolation(&terms, p);
                let left = last + found.weight * terms[2].mean;
                assert!(left.abs() <= found.size * (1.0 + 1e-9), "{p} {q}: {left}");
                // The first of higher order is met.
                assert!(q > p + 1.0 || left.abs() > 0.99 * found.size, "{p} {q}: {left}");
            }
            let (terms, last) = differences(|tau| a * tau.powf(p));
            let found = extrapolation(&terms, p);
            assert!((last + found.weight * terms[2].mean).abs() < 1e-14 && found.size < 1e-14);
        }
    }

    #[test]
    fn one_difference_bounds_nothing() {
        let (terms, _) = differences(|tau| tau);
        assert_eq!(extrapolation(&terms[..1], 1.0).size, f64::INFINITY);
        assert!(extrapolation(&terms[..2], 1.0).size < 1e-15);
    }
}
