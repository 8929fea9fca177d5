//! Convergence orders with intervals.

mod bootstrap;
mod describe;
mod misfit;
mod strong;
mod weak;

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

pub use bootstrap::root_mean_square_interval;
pub use misfit::misfits;
pub(crate) use strong::FEW_PATHS;
pub use strong::{Estimate, Logarithms, Terms, fit_strong};
pub use weak::{fit_independent, fit_weak, fit_weak_against, fit_weak_differences};

/// Confidence of the reported intervals.
const CONFIDENCE: f64 = 0.95;

/// Two-sided normal_quantile of the standard normal distribution.
#[must_use]
pub fn normal_quantile(confidence: f64) -> f64 {
    Normal::standard().inverse_cdf(0.5 + 0.5 * confidence)
}

/// Two-sided normal_quantile of Student's distribution.
#[must_use]
pub fn student_quantile(degrees: f64, confidence: f64) -> f64 {
    StudentsT::new(0.0, 1.0, degrees.max(1.0))
        .map_or(f64::INFINITY, |t| t.inverse_cdf(0.5 + 0.5 * confidence))
}
