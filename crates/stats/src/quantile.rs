//! Quantiles of intervals and probabilities of χ².

use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor, Normal, StudentsT};

/// Confidence of the reported intervals.
pub const CONFIDENCE: f64 = 0.95;

/// With so many degrees of freedom Student's quantiles are the normal ones to a millionth, and the
/// library's iteration may not end.
const NORMAL_DEGREES: f64 = 1e6;

/// The two-sided quantile: with probability `confidence` a standard variable is at most this far
/// from zero. The variable is Student's with so many degrees of freedom, or normal without any.
pub fn two_sided(confidence: f64, student_degrees: Option<f64>) -> f64 {
    let p = 0.5 + 0.5 * confidence;
    match student_degrees.filter(|&degrees| degrees < NORMAL_DEGREES) {
        None => Normal::standard().inverse_cdf(p),
        Some(degrees) => StudentsT::new(0.0, 1.0, degrees.max(1.0))
            .map_or(f64::INFINITY, |student| student.inverse_cdf(p)),
    }
}

/// The probability of so large a χ² with a known covariance; `None` without degrees of freedom. A
/// χ² that is not a number has probability zero.
pub fn chi_square_p_value(chi_square: f64, degrees: usize) -> Option<f64> {
    let chi_square = if chi_square.is_nan() { f64::INFINITY } else { chi_square };
    Some(ChiSquared::new(degrees as f64).ok()?.sf(chi_square))
}

/// The probability of so large a χ² with d degrees of freedom and a covariance estimated from n
/// samples; `None` without degrees of freedom.
///
/// χ² is then Hotelling's T² (*Ann. Math. Statist.* 2, 1931): T²(n − d)/(d(n − 1)) has the F
/// distribution with d and n − d degrees of freedom.
pub fn hotelling_p_value(t_square: f64, degrees: usize, samples: u64) -> Option<f64> {
    let (n, d) = (samples as f64, degrees as f64);
    let f = t_square * (n - d) / (d * (n - 1.0));
    Some(FisherSnedecor::new(d, n - d).ok()?.sf(f))
}
