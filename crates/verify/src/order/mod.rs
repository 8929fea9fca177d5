//! Convergence orders with intervals, and when an order is said to hold.

mod bootstrap;
mod describe;
mod misfit;
mod strong;
mod verdict;
mod weak;

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

pub use bootstrap::root_mean_square_interval;
pub use strong::fit_strong;
pub(crate) use strong::{FEW_PATHS, Logarithms, Terms};
pub use verdict::{ORDER_MARGIN, bound_verdict, order_verdict};
pub(crate) use weak::{fit_independent, fit_weak_against};
pub use weak::{fit_weak, fit_weak_differences};

/// Confidence of the reported intervals.
const CONFIDENCE: f64 = 0.95;

/// Two-sided quantile of the standard normal distribution.
fn quantile(confidence: f64) -> f64 {
    Normal::standard().inverse_cdf(0.5 + 0.5 * confidence)
}

/// Two-sided quantile of Student's distribution.
fn student(degrees: f64, confidence: f64) -> f64 {
    StudentsT::new(0.0, 1.0, degrees.max(1.0))
        .map_or(f64::INFINITY, |t| t.inverse_cdf(0.5 + 0.5 * confidence))
}

#[cfg(test)]
mod tests;
