//! Quantiles of intervals and probabilities of χ².

use std::f64::consts::{PI, TAU};

use real::elementary::{exp, ln};

use crate::special::{beta_below, gamma_above, ln_gamma};

/// Confidence of the reported intervals.
pub const CONFIDENCE: f64 = 0.95;

/// Degrees of freedom from which Student's quantiles are the normal ones to a millionth.
const NORMAL_DEGREES: f64 = 1e6;
/// The normal quantile of [`CONFIDENCE`].
const NORMAL: f64 = 1.959_963_984_540_054_2;
/// Largest number of Newton steps: heavy tails of probability 2⁻¹⁰⁰⁰ take a thousand.
const MAX_STEPS: u32 = 1000;

/// Two-sided quantile: with probability `confidence` a standard variable is at most this far from
/// zero. The variable is Student's with `student_degrees` degrees of freedom, or normal if `None`.
pub fn two_sided(confidence: f64, student_degrees: Option<f64>) -> f64 {
    let few = student_degrees.filter(|&degrees| degrees < NORMAL_DEGREES);
    let degrees = few.map(|degrees| degrees.max(1.0));
    if degrees.is_none() && confidence == CONFIDENCE {
        return NORMAL;
    }
    // ln of the density at 0, and what it falls by.
    let largest = match degrees {
        None => -0.5 * ln(TAU),
        Some(n) => ln_gamma(0.5 * n + 0.5) - ln_gamma(0.5 * n) - 0.5 * ln(n * PI),
    };
    let mut t = 0.0;
    // The tail is convex, so that Newton's method from 0 on does not pass the quantile.
    for _ in 0..MAX_STEPS {
        let square: f64 = t * t;
        let (tail, fall) = match degrees {
            None => (gamma_above(0.5, 0.5 * square), 0.5 * square),
            Some(n) => {
                let share = [n / (n + square), square / (n + square)];
                (beta_below(0.5 * n, 0.5, share), (0.5 * n + 0.5) * ln(1.0 + square / n))
            }
        };
        let next = t + (tail - (1.0 - confidence)) / (2.0 * exp(largest - fall));
        if next.is_nan() || next <= t * (1.0 + f64::EPSILON) {
            break;
        }
        t = next;
    }
    t
}

/// Probability of a χ² of at least `chi_square` with a known covariance; `None` without degrees of
/// freedom. A χ² that is not a number has probability zero.
pub fn chi_square_p_value(chi_square: f64, degrees: usize) -> Option<f64> {
    let chi_square = if chi_square.is_nan() { f64::INFINITY } else { chi_square };
    (degrees > 0).then(|| gamma_above(0.5 * degrees as f64, 0.5 * chi_square))
}

/// Probability of a χ² of at least `t_square` with d degrees of freedom and a covariance estimated
/// from n samples; `None` without degrees of freedom.
///
/// χ² is then Hotelling's T² (*Ann. Math. Statist.* 2, 1931): T²(n − d)/(d(n − 1)) has the F
/// distribution with d and n − d degrees of freedom.
pub fn hotelling_p_value(t_square: f64, degrees: usize, samples: u64) -> Option<f64> {
    let (n, d) = (samples as f64, degrees as f64);
    let ratio = t_square / (n - 1.0);
    let share = [1.0 / (1.0 + ratio), ratio / (1.0 + ratio)];
    (d > 0.0 && n > d).then(|| beta_below(0.5 * (n - d), 0.5 * d, share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        let close = |found: f64, exact: f64| (found / exact - 1.0).abs() < 1e-8;
        for (confidence, degrees, exact) in [
            (0.95, None, 1.959_963_984_5),
            (0.99, None, 2.575_829_303_5),
            (0.95, Some(1.0), 12.706_204_736),
            (0.95, Some(10.0), 2.228_138_852_0),
            (0.99, Some(10.0), 3.169_272_672_6),
            // Fewer than one degree of freedom counts as one, and a million as all.
            (0.95, Some(0.3), 12.706_204_736),
            (0.95, Some(1e6), 1.959_963_984_5),
            (0.95, Some(1e12), 1.959_963_984_5),
            // z + (z³ + z)/(4ν): the library used before is off by 2e-4 here.
            (0.95, Some(999_000.0), 1.959_966_359_1),
            // cot(π/2⁵¹).
            (1.0 - 2f64.powi(-50), Some(1.0), 2f64.powi(51) / PI),
        ] {
            let found = two_sided(confidence, degrees);
            assert!(close(found, exact), "{confidence} {degrees:?}: {found}");
        }
    }

    #[test]
    fn probabilities_are_the_closed_ones_of_two_degrees() {
        for x in [0.1f64, 1.0, 7.0] {
            let known = chi_square_p_value(x, 2).unwrap();
            assert!((known - (-0.5 * x).exp()).abs() < 1e-12, "{x}");
            // F = T²(n − 2)/(2(n − 1)) exceeds f with probability (1 + 2f/(n − 2))^{−(n − 2)/2}.
            let n = 12.0;
            let f = x * (n - 2.0) / (2.0 * (n - 1.0));
            let exact = (1.0 + 2.0 * f / (n - 2.0)).powf(-0.5 * (n - 2.0));
            let estimated = hotelling_p_value(x, 2, 12).unwrap();
            assert!((estimated - exact).abs() < 1e-12, "{x}: {estimated} {exact}");
        }
        assert_eq!(chi_square_p_value(f64::NAN, 2), Some(0.0));
        assert_eq!((chi_square_p_value(1.0, 0), hotelling_p_value(1.0, 0, 12)), (None, None));
    }
}
