//! The interval of a probability.

use crate::quantile::{CONFIDENCE, two_sided};

/// 95 % interval of a probability from `count` successes in `number` trials: Wilson's score
/// interval with a correction for continuity (Newcombe, *Stat. Med.* 17, 1998). From 100 trials on
/// it covers any probability with 95 % or more.
#[must_use]
pub fn proportion(count: u64, number: u64) -> (f64, f64) {
    let (n, z) = (number as f64, two_sided(CONFIDENCE, None));
    let (p, square) = (count as f64 / n, z * z);
    let end = |sign: f64| {
        let under = square - 1.0 / n + 4.0 * n * p * (1.0 - p) - sign * (4.0 * p - 2.0);
        let root = z * under.max(0.0).sqrt() + 1.0;
        ((2.0 * n * p + square + sign * root) / (2.0 * (n + square))).clamp(0.0, 1.0)
    };
    let lower = if count == 0 { 0.0 } else { end(-1.0) };
    (lower, if count == number { 1.0 } else { end(1.0) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Probability that the interval of `number` trials covers p.
    fn coverage(number: u64, p: f64, interval: impl Fn(u64) -> (f64, f64)) -> f64 {
        let mut weight = (number as f64 * (-p).ln_1p()).exp();
        let mut covered = 0.0;
        for count in 0..=number {
            let (lo, hi) = interval(count);
            covered += if (lo..=hi).contains(&p) { weight } else { 0.0 };
            weight *= (number - count) as f64 / (count + 1) as f64 * p / (1.0 - p);
        }
        covered
    }

    #[test]
    fn every_probability_is_covered_and_not_by_an_interval_without_correction() {
        for number in [100, 300] {
            let probabilities = (1..500).map(|k| f64::from(k) / 997.0).chain([1e-4, 5e-4, 2e-3]);
            let least = |interval: fn(u64, u64) -> (f64, f64)| {
                let of = |p| coverage(number, p, |count| interval(count, number));
                probabilities.clone().map(of).fold(1.0, f64::min)
            };
            let without = |count: u64, number: u64| {
                let (n, k) = (number as f64, count as f64);
                let half_width = 1.96 * (k / n * (1.0 - k / n) / n).sqrt();
                (k / n - half_width, k / n + half_width)
            };
            let (right, wrong) = (least(proportion), least(without));
            assert!(right >= 0.95 && wrong < 0.5, "{number}: {right}, {wrong}");
        }
        let (lo, hi) = proportion(1, 1000);
        assert!((lo - 5.22e-5).abs() < 1e-7 && (hi - 6.469e-3).abs() < 1e-6, "{lo} {hi}");
        assert_eq!((proportion(0, 100).0, proportion(100, 100).1), (0.0, 1.0));
    }
}
