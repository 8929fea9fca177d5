//! How many false alarms are to be expected, and how many are too many.

use analysis::results::{Claim, Evidence};
use report::Outcome;
use statrs::distribution::{DiscreteCDF, Poisson};

/// The most often that an order is refuted by chance: a 99.9 % interval misses on one side.
const ORDER_ALARM: f64 = 0.0005;
/// The most often that any other check fails by chance; most have no statistical error at all.
const CHECK_ALARM: f64 = 1e-5;

/// The most false alarms to be expected among the verdicts, misprints aside.
pub fn expected_alarms<'a>(verdicts: impl Iterator<Item = &'a Claim>) -> f64 {
    let alarm = |claim: &Claim| match (Outcome::of(claim), &claim.measured) {
        (Outcome::Misprint, _) => 0.0,
        (_, Evidence::Order { .. }) => ORDER_ALARM,
        _ => CHECK_ALARM,
    };
    verdicts.map(alarm).sum()
}

/// The smallest k that a Poisson number with this mean exceeds with a probability of at most 1 −
/// `confidence`.
pub fn poisson_quantile(mean: f64, confidence: f64) -> u64 {
    // A mean of zero has no Poisson law.
    Poisson::new(mean).map_or(0, |law| law.inverse_cdf(confidence))
}

/// The least power with which `trials` out of `trials` refutations are no surprise at 95 %
/// confidence: pⁿ = 5 %.
pub fn least_power(trials: u64) -> f64 {
    0.05f64.powf(1.0 / trials.max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn textbook_quantiles() {
        // Poisson tables: P(X ≤ 5 | 1) = 0.99941, P(X ≤ 4 | 1) = 0.99634; P(X ≤ 0 | 0.0005) =
        // 0.9995.
        assert_eq!(poisson_quantile(1.0, 0.999), 5);
        assert_eq!(poisson_quantile(1.0, 0.99), 4);
        assert_eq!(poisson_quantile(0.0005, 0.999), 0);
        assert_eq!(poisson_quantile(0.0, 0.999), 0);
    }

    #[test]
    fn the_rule_of_three() {
        assert!((least_power(100) - 0.9705).abs() < 1e-4);
        assert!((least_power(1) - 0.05).abs() < 1e-15);
    }
}
