//! Order statistics that enclose a quantile.

use crate::{
    quantile::{CONFIDENCE, two_sided},
    special::beta_below,
};

/// Standard deviation of the number of samples below a quantile from which its binomial law is
/// taken as normal.
const NORMAL_DEVIATION: f64 = 500.0;
/// Largest difference of the quantiles of the binomial law from those of the normal law: the
/// skewness shifts them by |1 − 2q|(1.96² − 1)/6 < 0.48, and they are integers.
const NORMAL_ERROR: f64 = 2.0;

/// Ranks l and u with P(X₍ₗ₎ ≤ x ≤ X₍ᵤ₎) ≥ 0.95, where X₍₁₎ ≤ … ≤ X₍ₙ₎ are n independent samples
/// of any law, continuous or not, and x is its quantile at `level`, 0 < level < 1. Each end is
/// missed with probability 0.025 at most. l = 0 or u = n + 1 says that there are too few samples to
/// bound that end.
///
/// X₍ₗ₎ > x means that at most l − 1 samples are ≤ x. Their number is binomial with a probability
/// of at least `level`, so l is the largest rank with P(Bin(n, level) ≤ l − 1) ≤ 0.025. Likewise u
/// is the smallest with P(Bin(n, level) ≥ u) ≤ 0.025 (Conover, *Practical Nonparametric
/// Statistics*).
pub fn quantile_ranks(n: u64, level: f64) -> (u64, u64) {
    let deviation = (n as f64 * level * (1.0 - level)).sqrt();
    if deviation < NORMAL_DEVIATION {
        (lower(n, level), n + 1 - lower(n, 1.0 - level))
    } else {
        by_normal_law(n, level, deviation)
    }
}

fn by_normal_law(n: u64, level: f64, deviation: f64) -> (u64, u64) {
    let (mean, reach) = (n as f64 * level, two_sided(CONFIDENCE, None) * deviation + NORMAL_ERROR);
    ((mean - reach).max(0.0) as u64, ((mean + reach).ceil() as u64).min(n + 1))
}

/// Largest l with P(Bin(n, q) ≤ l − 1) ≤ 0.025: the least one with P(Bin(n, q) ≤ l) > 0.025, where
/// P(Bin(n, q) ≤ l) = I_{1−q}(n − l, l + 1) for l < n.
fn lower(n: u64, q: f64) -> u64 {
    let (mut low, mut high) = (0, n);
    while low < high {
        let l = low + (high - low) / 2;
        let below = beta_below((n - l) as f64, (l + 1) as f64, [1.0 - q, q]);
        (low, high) = if below > 0.5 * (1.0 - CONFIDENCE) { (low, l) } else { (l + 1, high) };
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::distribution::{Binomial, DiscreteCDF};

    #[test]
    fn ranks_are_the_quantiles_of_the_binomial_law() {
        for n in [0, 1, 5, 20, 72, 73, 400, 5000] {
            for level in [1e-3, 0.05, 0.25, 0.5, 0.75, 0.95, 0.999] {
                let (l, u) = quantile_ranks(n, level);
                let law = Binomial::new(level, n).unwrap();
                // P(Bin ≤ l − 1) and P(Bin ≥ u).
                let low = |l: u64| if l == 0 { 0.0 } else { law.cdf(l - 1) };
                let high = |u: u64| if u == 0 { 1.0 } else { law.sf(u - 1) };
                assert!(low(l) <= 0.025 && (l > n || low(l + 1) > 0.025), "{n} {level}: {l}");
                assert!(high(u) <= 0.025 && (u == 0 || high(u - 1) > 0.025), "{n} {level}: {u}");
            }
        }
        // Of 72 samples the first may lie above the 5 % quantile: 0.95⁷² = 0.0249.
        assert_eq!((quantile_ranks(72, 0.05).0, quantile_ranks(71, 0.05).0), (1, 0));
    }

    #[test]
    fn normal_ranks_enclose_the_binomial_ones_and_little_more() {
        for level in [0.01, 0.05, 0.5, 0.9] {
            for deviation in [100.0, 400.0] {
                let n = (deviation * deviation / (level * (1.0 - level))) as u64;
                let exact = (lower(n, level), n + 1 - lower(n, 1.0 - level));
                let normal = by_normal_law(n, level, deviation);
                assert!(normal.0 <= exact.0 && exact.0 <= normal.0 + 4, "{normal:?} {exact:?}");
                assert!(exact.1 <= normal.1 && normal.1 <= exact.1 + 4, "{normal:?} {exact:?}");
            }
        }
        let (l, u) = quantile_ranks(1_000_000_000_000, 0.5);
        assert!(l < 499_999_020_019 && u > 500_000_979_981 && u - l < 1_959_970);
    }
}
