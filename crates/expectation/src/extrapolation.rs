//! The limit τ → 0 from several levels, and a bound on what is left.
//!
//! With E_l = E[φ(y_l)], d_l = E_l − E_{l−1} and the weak order p, R_l = E_l + c·d_l with c =
//! 1/(2^p − 1) has no error of order p (Richardson; Talay and Tubaro 1990). If the next order of
//! the expansion is q, S_L = R_L + c′(R_L − R_{L−1}) with c′ = 1/(2^q − 1) has none of order q.
//!
//! What is left of S_L is at most c′|R_L − R_{L−1}| if the error of R_l falls by order q − 1 + ε or
//! more, ε = log₂(1 + 2^{−q}): the bound does not rest on the power that S_L removes. (What is left
//! of R_L is within it only if the error falls by q or more, and the next power may make that
//! less.) c′2^{−q}|R_{L−1} − R_{L−2}| is a second bound, and the larger one is taken: one alone may
//! be small by chance.
//!
//! Where the differences are seen to fall by less than order p, all of them or one to the next,
//! there is no such expansion yet. c then has the least observed order, and the whole extrapolated
//! part c|d_L| is the bound. Where φ is rough, the largest of the last three takes its place, since
//! their means are hardly known and may pass through zero.
//!
//! **Single paths** of level L, where levels do not help, are extrapolated by the difference two
//! levels below, which costs a quarter: by 2^{−2p}c·d_{L−2}. The largest of that, 2^{−p}c·d_{L−1}
//! and c·d_L is the bound, errors of sampling included: single paths may be known better than the
//! differences, which then show no bias however large it is beside the error of the paths.

use std::f64::consts::LN_2;

use real::elementary::{exp, ln};

use super::{
    Orders,
    level::Samples,
    report::{QUANTILE, Rate},
    rules::{LOWEST_ORDER, ORDER_TOLERANCE, SIGNIFICANT, SMOOTH, WHOLE},
    sum::Term,
};

/// The orders that differences without errors of sampling show, the last one last, if they are
/// whole numbers: the first by d_{L−1}/d_L and d_{L−2}/d_{L−1}, the second by those of R; else
/// `given`.
pub fn seen_orders(differences: &[Term], given: Orders) -> Orders {
    let order = |before: f64, last: f64| ln((before / last).max(0.0)) / LN_2;
    let whole =
        |x: f64, width: f64| (x.round() >= 1.0 && (x - x.round()).abs() < width).then(|| x.round());
    let [.., a, b, c] = differences else { return given };
    let Some(weak) = whole(order(b.mean, c.mean), WHOLE) else { return given };
    if whole(order(a.mean, b.mean), 0.5) != Some(weak) {
        return given;
    }
    let factor = 1.0 / (exp(weak * LN_2) - 1.0);
    let change = |last: &Term, before: &Term| (1.0 + factor) * last.mean - factor * before.mean;
    let next = whole(order(change(b, a), change(c, b)), WHOLE).filter(|next| *next > weak);
    Orders { weak, next: next.unwrap_or(weak + 1.0).min(2.0 * weak + 2.0) }
}

/// The least order that is believed: a lower one is not what the extrapolation assumes.
pub fn lowest(given: f64) -> f64 {
    LOWEST_ORDER.min(0.5 * given)
}

/// The extrapolation of one test function.
pub struct Extrapolation {
    /// Weights of the last difference but one and the last one, beside one; below single paths the
    /// weights of the two differences.
    pub weights: [f64; 2],
    /// Bound on the bias, without a statistical margin.
    pub size: f64,
    /// Standard error of the difference that makes the bound.
    pub standard_error: f64,
}

impl Extrapolation {
    /// No extrapolation, for what has no expansion in the step: the error of the time at which a
    /// path without noise crosses a line depends on the place in a step, and may be small by
    /// chance. The bound is twice the largest difference, each brought to the last step by order
    /// one.
    pub fn of_no_order(differences: &[Term]) -> Self {
        let at_last = |size: f64, term: &Term| (0.5 * size).max(term.mean.abs());
        let size = 2.0 * differences.iter().fold(0.0, at_last);
        Self { weights: [0.0; 2], size, standard_error: 0.0 }
    }
}

/// Extrapolates by the last three differences or fewer, the last one last, of which the last two
/// are terms of the sum; or, for `single` paths of the last level, the first two. The scheme has
/// these orders; differences fall by the order `alpha`, and their variances by `beta`.
pub fn extrapolation(
    differences: &[Term],
    orders: Orders,
    (alpha, beta): (Option<Rate>, Option<Rate>),
    single: bool,
) -> Extrapolation {
    let lowest = lowest(orders.weak);
    // The upper end of the observed order, if that is less than the one given.
    let seen = alpha.map_or(orders.weak, |alpha| orders.weak.min(alpha.upper).max(lowest));
    let least = differences
        .windows(2)
        .filter_map(|pair| local_order(&pair[0], &pair[1]))
        .fold(seen, f64::min);
    let falls = least >= orders.weak - ORDER_TOLERANCE;
    let order = if falls { orders.weak } else { least.max(lowest) };
    let rough = beta.is_some_and(|beta| beta.value < SMOOTH);
    let expands = falls && !rough;
    let one_over = |order: f64| 1.0 / (exp(order * LN_2) - 1.0);
    let (c, next) = (one_over(order), one_over(orders.next));
    // c′(R_L − R_{L−1}), in differences.
    let change = |last: &Term, before: &Term| {
        let mean = (1.0 + c) * last.mean - c * before.mean;
        let square = (1.0 + c).powi(2) * last.variance + c * c * before.variance;
        (next * mean.abs(), next * square.sqrt())
    };
    let whole = |term: &Term| (c * term.mean.abs(), c * term.variance.sqrt());
    let larger = |a: (f64, f64), b: (f64, f64)| if a.0 < b.0 { b } else { a };
    if let ([below, between, last], true) = (differences, single) {
        let falls = exp(-order * LN_2);
        let weight = c * falls * falls;
        let scaled = |(size, error): (f64, f64), by: f64| (by * size, by * error);
        let smaller = [scaled(whole(between), falls), scaled(whole(below), falls * falls)];
        let (size, standard_error) = smaller.into_iter().fold(whole(last), larger);
        return Extrapolation { weights: [weight, 0.0], size, standard_error };
    }
    let (size, standard_error) = match differences {
        [.., _, _] if rough => differences.iter().map(whole).fold((0.0, 0.0), larger),
        [.., _, last] if !expands => whole(last),
        [before, between, last] => {
            let (size, error) = change(between, before);
            let falls = next / (1.0 + next);
            larger(change(last, between), (falls * size, falls * error))
        }
        [.., before, last] => change(last, before),
        _ => (f64::INFINITY, 0.0),
    };
    let weights = if expands { [-next * c, c + next * (1.0 + c)] } else { [0.0, c] };
    Extrapolation { weights, size, standard_error }
}

/// Upper end of the order by which one difference falls to the next, if both are significant and of
/// one sign.
fn local_order(before: &Term, last: &Term) -> Option<f64> {
    let square = |term: &Term| term.variance / (term.mean * term.mean);
    let significant = |term: &Term| SIGNIFICANT * SIGNIFICANT * square(term) < 1.0;
    let ratio = before.mean / last.mean;
    if !(significant(before) && significant(last) && ratio > 0.0) {
        return None;
    }
    Some((ln(ratio) + QUANTILE * (square(before) + square(last)).sqrt()) / LN_2)
}

/// Rate at which the means of the differences fall, if all that are significant have one sign.
pub fn alpha(differences: &[Samples], terms: &[Term], k: usize) -> Option<Rate> {
    let margin = |term: &Term| SIGNIFICANT * term.variance.sqrt() + term.missed;
    let significant = differences
        .iter()
        .zip(terms)
        .filter(|(samples, term)| samples.values[k].varies() && term.mean.abs() > margin(term));
    let positive = significant.clone().filter(|(_, term)| term.mean > 0.0).count();
    if positive != 0 && positive != significant.clone().count() {
        return None;
    }
    let point = |(samples, term): (&Samples, &Term)| {
        let relative = term.variance / (term.mean * term.mean * LN_2 * LN_2);
        (samples.level, log2(term.mean.abs()), relative)
    };
    decay(&significant.map(point).collect::<Vec<_>>())
}

/// Rate at which the variances of the differences fall. The relative variance of a sample variance
/// is (kurtosis − 1)/N.
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
    ln(x) / LN_2
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

    fn differences(error: impl Fn(f64) -> f64) -> (Vec<Term>, f64) {
        let at = |l: i32| error(f64::powi(0.5, l));
        let term = |mean: f64| Term { mean, ..Term::default() };
        ((1..4).map(|l| term(at(l) - at(l - 1))).collect(), at(3))
    }

    /// Remainder of the last error after extrapolation.
    fn left(terms: &[Term], last: f64, found: &Extrapolation) -> f64 {
        last + found.weights[0] * terms[1].mean + found.weights[1] * terms[2].mean
    }

    #[test]
    fn the_bound_holds_what_extrapolation_leaves() {
        for (weak, next) in [(2.0, 4.0), (2.0, 3.0), (1.0, 2.0)] {
            let orders = Orders { weak, next };
            for (a, b) in [(1.0, 0.5), (1.0, -3.0), (0.0, 1.0), (2.0, -0.7)] {
                for q in [next - 0.6, next, next + 1.0, 2.0 * next] {
                    let (terms, last) =
                        differences(|tau| a * tau.powf(weak) + b * tau.powf(q.max(weak)));
                    let found = extrapolation(&terms, orders, (None, None), false);
                    let two = left(&terms, last, &found);
                    assert!(two.abs() <= found.size * (1.0 + 1e-9), "{weak} {next} {q}: {two}");
                    // There is no expansion yet.
                    if found.weights[0] == 0.0 {
                        continue;
                    }
                    // R_L needs the order q, S_L one less.
                    let c = 1.0 / (weak.exp2() - 1.0);
                    let one = last + c * terms[2].mean;
                    let held = one.abs() <= found.size * (1.0 + 1e-9);
                    assert!(held == (q >= next), "{weak} {next} {q}: {one}");
                    if q == next {
                        assert!(two.abs() < 1e-14 && one.abs() > 0.99 * found.size);
                    }
                }
            }
        }
    }

    #[test]
    fn without_an_expansion_the_whole_is_the_bound() {
        let (terms, _) = differences(|tau| tau.powf(1.2));
        let slow = Rate { value: 1.0, lower: 0.9, upper: 1.1 };
        let orders = Orders { weak: 2.0, next: 3.0 };
        let found = extrapolation(&terms, orders, (Some(slow), None), false);
        let (weight, last) = (1.0 / (1.1f64.exp2() - 1.0), terms[2].mean.abs());
        assert!(found.weights[0] == 0.0 && (found.weights[1] - weight).abs() < 1e-14);
        assert!((found.size - weight * last).abs() < 1e-14);
        // The upper end of an observed order counts.
        let (terms, _) = differences(|tau| tau.powf(1.8));
        let near = Rate { value: 1.7, lower: 1.5, upper: 1.9 };
        assert!(extrapolation(&terms, orders, (Some(near), None), false).weights[0] != 0.0);
    }

    #[test]
    fn two_differences_that_hardly_fall_are_no_expansion() {
        // Orders 0.76 and 1.8, where the changes of R happen to be small.
        let term = |mean: f64| Term { mean, ..Term::default() };
        let terms = [0.0303, 0.0179, 0.00518].map(term);
        let orders = Orders { weak: 2.0, next: 4.0 };
        let found = extrapolation(&terms, orders, (None, None), false);
        let weight = 1.0 / (0.0303 / 0.0179 - 1.0);
        assert!(found.weights[0] == 0.0 && (found.weights[1] / weight - 1.0).abs() < 1e-11);
        assert!(found.size > 0.00518, "{}", found.size);
        // Of a rough φ the largest counts.
        let beta = Rate { value: 1.0, lower: 0.9, upper: 1.1 };
        let rough = extrapolation(&terms, orders, (None, Some(beta)), false);
        assert!(rough.size > 0.0303 && rough.weights[0] == 0.0, "{}", rough.size);
        // Differences of noise say nothing.
        let noisy = terms.map(|term| Term { variance: 1.0, ..term });
        assert!(extrapolation(&noisy, orders, (None, None), false).weights[0] != 0.0);
    }

    #[test]
    fn single_paths_are_extrapolated_from_two_levels_below() {
        for (weak, next) in [(1.0, 2.0), (2.0, 4.0)] {
            let orders = Orders { weak, next };
            for more in [-0.2, 0.0, 0.5, 1.0, 3.0] {
                let (terms, last) = differences(|tau| tau.powf(weak + more));
                let found = extrapolation(&terms, orders, (None, None), true);
                let left = last + found.weights[0] * terms[0].mean;
                assert!(left.abs() <= found.size * (1.0 + 1e-9), "{weak} {more}");
                assert!(found.weights[1] == 0.0 && (more != 0.0 || left.abs() < 1e-14));
            }
            // A difference below that passes through zero does not hide the last ones, whether they
            // are significant or not.
            let c = 1.0 / (weak.exp2() - 1.0);
            for (means, size, of) in [([0.0, 0.02, 0.01], 0.01, 2), ([0.0, 0.08, 0.01], 0.08, 1)] {
                let part = if of == 1 { (-weak).exp2() } else { 1.0 };
                let errors = [0.1, 0.2, 0.3];
                let term = |n: usize| Term {
                    mean: means[n],
                    variance: errors[n] * errors[n],
                    ..Term::default()
                };
                let found = extrapolation(&[0, 1, 2].map(term), orders, (None, None), true);
                assert!((found.size - c * part * size).abs() < 1e-12, "{}", found.size);
                assert!((found.standard_error - c * part * errors[of]).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn one_difference_bounds_nothing() {
        let (terms, _) = differences(|tau| tau);
        let orders = Orders { weak: 1.0, next: 2.0 };
        assert_eq!(extrapolation(&terms[..1], orders, (None, None), false).size, f64::INFINITY);
        assert!(extrapolation(&terms[..2], orders, (None, None), false).size < 1e-15);
    }
}
