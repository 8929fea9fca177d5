//! Whether a scheme converges to the right limit, against an exact solution.
//!
//! Without one, [`consistency`](super::consistency()) sees it in single steps.

use real::elementary::exp2;
use std::f64::consts::FRAC_1_SQRT_2;

use stats::CrossMoments;

/// Whether a scheme converges to the solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// One step has the drift and the noise of the equation as τ → 0.
    Consistent {
        /// The largest error that single steps may have, as a part of |y| per unit of time or root
        /// of it.
        defect: f64,
    },
    /// One step has another drift or noise as τ → 0: the scheme converges to something else.
    Inconsistent {
        /// The error of single steps, as a part of |y| per unit of time or root of it.
        defect: f64,
    },
    /// Distance from the exact solution is small beside the errors measured.
    Agrees {
        /// Upper end of the interval of the distance.
        distance: f64,
    },
    /// The scheme converges to something else than the exact solution.
    Differs {
        /// The distance of the limits.
        distance: f64,
    },
    /// The steps are too coarse, or the paths too few, to tell.
    Unclear {
        /// Upper end of the interval of the distance.
        distance: f64,
    },
    /// Unchecked: single steps show nothing.
    Unchecked,
}

/// Halvings of the step size between the two at which distances are compared.
const SPAN: usize = 3;
/// The part of the mean-square distance at the finest step that may be left in the limit.
const LEFT: f64 = 0.5;
/// Normal quantile of a two-sided interval of 95 %.
const QUANTILE: f64 = 1.96;
/// Sum Σ_{j ≥ 1} 2^{−j/2}: bound of an error of order ½, the slowest, in units of the difference
/// y_τ − y_{τ/2}.
const TAIL: f64 = 2.42;

/// Upper bound of the constant c of mean squares X = c + Aτ + … with positive terms, from those at
/// two step sizes that are 2^`halvings` apart: c ≤ (2ⁿX(τ) − X(2ⁿτ))/(2ⁿ − 1), with its 95 %
/// half-width.
fn constant(squares: &CrossMoments, [far, near]: [usize; 2], halvings: usize) -> (f64, f64) {
    let growth = exp2(halvings as f64);
    let mut row = vec![0.0; squares.length()];
    row[near] = growth / (growth - 1.0);
    row[far] = -1.0 / (growth - 1.0);
    let constant = squares.combined(&[row]);
    (constant.mean(0), half_width(&constant, 0))
}

/// Half-width of the 95 % interval of mean number i.
fn half_width(moments: &CrossMoments, i: usize) -> f64 {
    QUANTILE * moments.standard_error(i)
}

/// The distance of the limit from that of a reference, if squared errors against the reference
/// stay while the differences of successive step sizes, coarsest first, fall; `None` where the
/// limits agree or cannot be told apart.
pub fn wrong_limit(errors: &CrossMoments, differences: &CrossMoments) -> Option<f64> {
    let finest = errors.length().checked_sub(1).filter(|&finest| finest > 0)?;
    let near = errors.mean(finest);
    let (constant, half_width) = constant(errors, [0, finest], finest);
    let own = differences.mean(finest - 1);
    (constant - half_width > LEFT * near && near.sqrt() > 2.0 * TAIL * own.sqrt())
        .then_some(near.sqrt())
}

/// Judges the limit by errors against a reference whose own error is about `reference`. Errors of a
/// right limit are at most what differences of successive step sizes leave, by the triangle
/// inequality: Σ_{j ≥ 1} rʲ times the last one, if they fall by r as the last two do, between
/// 2^{−½} and ¼. Half as much more is allowed for differences that do not fall so yet. Errors of
/// three times as much that stay are those of another limit.
pub fn strong_limit(errors: &CrossMoments, differences: &CrossMoments, reference: f64) -> Limit {
    let (finest, last) = (errors.length() - 1, differences.length() - 1);
    let end = |l: usize, side: f64| (errors.mean(l) + side * half_width(errors, l)).max(0.0).sqrt();
    let difference = |l: usize| differences.mean(l).sqrt();
    let left = difference(last) * tail(difference(last), difference(last - 1));
    let (lo, hi) = (end(finest, -1.0), end(finest, 1.0));
    let stays = errors.mean(finest) > LEFT * errors.mean(finest - 1);
    if hi <= 1.5 * left + 2.0 * reference {
        Limit::Agrees { distance: hi }
    } else if stays && lo > 3.0 * (left + reference) {
        Limit::Differs { distance: errors.mean(finest).sqrt() }
    } else {
        Limit::Unclear { distance: hi }
    }
}

/// Remaining error in units of the last difference, Σ_{j ≥ 1} rʲ, if differences fall by r as the
/// last two do, between 2^{−½}, of order ½, and ¼.
fn tail(last: f64, before: f64) -> f64 {
    // All are zero where the solver is exact.
    let ratio = (last / before.max(f64::MIN_POSITIVE)).clamp(0.25, FRAC_1_SQRT_2);
    ratio / (1.0 - ratio)
}

/// Judges the limit by its distance |E[φ(y) − φ(x)]|, from the means of φ(y_k) − φ(y_{k+1}) and of
/// that at the finest step, more than [`SPAN`] in all. The error is what the last difference
/// leaves, as in [`strong_limit`] with the ends of intervals, or at least that difference, as for
/// order one.
pub fn weak_limit(differences: &CrossMoments) -> Limit {
    let last = differences.length() - 1;
    let mean = |i: usize| differences.mean(i).abs();
    let (near, own, noise) = (mean(last), mean(last - 1), half_width(differences, last));
    let coarse = (last - SPAN..last).map(|k| differences.mean(k)).sum::<f64>().abs();
    let errors = own + half_width(differences, last - 1);
    let left = errors * tail(errors, mean(last - 2) - half_width(differences, last - 2)).max(1.0);
    let distance = near + noise;
    if near > 2.0 * (noise + left) {
        Limit::Differs { distance: near }
    } else if distance <= (1.0 - LEFT) * coarse.max(own) || distance <= 2.0 * errors.min(coarse) {
        Limit::Agrees { distance }
    } else {
        Limit::Unclear { distance }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Moments of 64 paths with these means, of which each is spread by this part of it.
    fn spread<const N: usize>(means: [f64; N], parts: [f64; N]) -> CrossMoments {
        let mut moments = CrossMoments::new(N);
        for path in 0..64 {
            let sign = if path % 2 == 0 { 1.0 } else { -1.0 };
            let numbers: Vec<f64> = (0..N).map(|i| means[i] * (1.0 + sign * parts[i])).collect();
            moments.add(&numbers);
        }
        moments
    }

    #[test]
    fn the_constant_of_a_line_is_extrapolated_with_its_noise() {
        // 9 and 2 three halvings apart: (8·2 − 9)/7 = 1, times 1 ± ½ on 64 paths.
        let squares = spread([9.0, 2.0], [0.5; 2]);
        for (pair, halvings, exact) in [([0, 1], 3, 1.0), ([1, 0], 1, 16.0)] {
            let (found, width) = constant(&squares, pair, halvings);
            assert!((found - exact).abs() < 1e-12, "{found}");
            assert!((width / exact / HALF - 1.0).abs() < 1e-9, "{width}");
        }
    }

    /// Half the width of the interval of a mean of one that is spread by a half.
    const HALF: f64 = 0.5 * 1.96 / 7.937_253_933_193_772;

    /// Whether this is A, D or U, for agrees, differs or unclear, with the distance; up to
    /// rounding, whose root is the standard error of what is not spread.
    fn is(limit: Limit, what: char, distance: f64) -> bool {
        let (found, of) = match limit {
            Limit::Agrees { distance } => ('A', distance),
            Limit::Differs { distance } => ('D', distance),
            Limit::Unclear { distance } => ('U', distance),
            other => panic!("{other:?}"),
        };
        found == what && (of / distance - 1.0).abs() < 64.0 * f64::EPSILON.sqrt()
    }

    #[test]
    fn errors_of_paths_are_what_differences_leave() {
        // Differences fall by ½: those left are as large as the last, 1.
        let of = |errors: [f64; 3], reference: f64| {
            let errors = spread(errors.map(|error| error * error), [0.0; 3]);
            strong_limit(&errors, &spread([4.0, 1.0], [0.0; 2]), reference)
        };
        assert!(is(of([4.0, 2.0, 1.0], 0.0), 'A', 1.0));
        assert!(is(of([4.0, 2.0, 1.49], 0.0), 'A', 1.49));
        assert!(is(of([4.0, 2.0, 1.51], 0.0), 'U', 1.51));
        // The reference has an error, too.
        assert!(is(of([4.0, 2.0, 1.69], 0.1), 'A', 1.69));
        // Errors that stay at more than three times; those that fall to ½ in the square may be
        // right.
        assert!(is(of([3.2, 3.1, 3.01], 0.0), 'D', 3.01));
        assert!(is(of([3.2, 3.1, 2.99], 0.0), 'U', 2.99));
        assert!(is(of([8.0, 4.4, 3.1], 0.0), 'U', 3.1));
        // Of a solver that is exact nothing is left.
        let exact = spread([1e-8; 3], [0.0; 3]);
        let none = spread([0.0; 2], [0.0; 2]);
        assert!(is(strong_limit(&exact, &none, 1e-4), 'A', 1e-4));
        assert!(is(strong_limit(&exact, &none, 1e-6), 'D', 1e-4));
    }

    #[test]
    fn means_differ_beyond_twice_their_noise_and_errors() {
        // Differences fall by ½, as of order one: those left are as large as the last.
        let of = |own: f64, coarse: f64, parts: [f64; 2]| {
            let means = [coarse - 3.0 * own, 2.0 * own, own, -1.0];
            weak_limit(&spread(means, [0.0, 0.0, parts[1], parts[0]]))
        };
        assert!(is(of(0.49, 0.1, [0.0; 2]), 'D', 1.0));
        // Twice errors of 0.51, half of the change by the step size, or twice of that.
        assert!(is(of(0.51, 0.45, [0.0; 2]), 'U', 1.0));
        assert!(is(of(0.51, 0.51, [0.0; 2]), 'A', 1.0));
        assert!(is(of(0.51, 2.1, [0.0; 2]), 'A', 1.0));
        assert!(is(of(0.4, 2.1, [0.0; 2]), 'D', 1.0));
        // Noise of the distance.
        assert!(is(of(0.37, 0.1, [0.5, 0.0]), 'D', 1.0));
        assert!(is(of(0.38, 0.1, [0.5, 0.0]), 'U', 1.0 + HALF));
        // Of order ½ 2.41 times the last is left, so that a right limit is not another: with noise
        // of the last difference it is not known to fall faster.
        let half = |own: f64, part: f64, fall: f64| {
            weak_limit(&spread([0.0, own / fall, own, -1.0], [0.0, 0.0, part, 0.0]))
        };
        let left = 1.0 / (1.0 - FRAC_1_SQRT_2) - 1.0;
        assert!(is(half(0.49 / left, 0.0, FRAC_1_SQRT_2), 'D', 1.0));
        assert!(is(half(0.51 / left, 0.0, FRAC_1_SQRT_2), 'U', 1.0));
        // 1 + HALF times the last, of ½ (1 + HALF) of the one before.
        let (own, ratio) = (1.0 + HALF, 0.5 * (1.0 + HALF));
        let left = own * ratio / (1.0 - ratio);
        assert!(is(half(0.499 / left, 0.5, 0.5), 'D', 1.0));
        assert!(is(half(0.501 / left, 0.5, 0.5), 'U', 1.0));
    }
}
