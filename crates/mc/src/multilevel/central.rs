//! Mean, variance, kurtosis and range of one quantity, without cancellation.

/// Number, mean, the sums of the second, third and fourth powers of the deviations from it, and the
/// least and the largest sample.
///
/// Merged by the pairwise formulas of Pébay (SAND2008-6212), which subtract no large sums: they
/// lose no digits where the mean is many times the standard deviation, as that of φ may be.
#[derive(Clone, Copy, Default)]
pub struct CentralMoments {
    count: u64,
    mean: f64,
    m2: f64,
    m3: f64,
    m4: f64,
    least: f64,
    largest: f64,
}

impl CentralMoments {
    pub fn add(&mut self, x: f64) {
        self.merge(&Self { count: 1, mean: x, least: x, largest: x, ..Self::default() });
    }

    /// Adds all samples of `later`.
    pub fn merge(&mut self, later: &Self) {
        if self.count == 0 || later.count == 0 {
            if self.count == 0 {
                *self = *later;
            }
            return;
        }
        let (a, b) = (self.count as f64, later.count as f64);
        let n = a + b;
        let delta = later.mean - self.mean;
        let step = delta / n;
        let square = delta * step * a * b;
        let m4 = self.m4
            + later.m4
            + square * step * step * (a * a - a * b + b * b)
            + 6.0 * step * step * (a * a * later.m2 + b * b * self.m2)
            + 4.0 * step * (a * later.m3 - b * self.m3);
        let m3 = self.m3
            + later.m3
            + square * step * (a - b)
            + 3.0 * step * (a * later.m2 - b * self.m2);
        let m2 = self.m2 + later.m2 + square;
        *self = Self {
            count: self.count + later.count,
            mean: self.mean + b * step,
            m2,
            m3,
            m4,
            least: self.least.min(later.least),
            largest: self.largest.max(later.largest),
        };
    }

    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Sample variance; NaN with fewer than two samples.
    pub fn variance(&self) -> f64 {
        self.m2 / (self.count as f64 - 1.0)
    }

    /// Squared standard error of the mean; NaN with fewer than two samples.
    pub fn variance_of_mean(&self) -> f64 {
        self.variance() / self.count as f64
    }

    /// E[(x − Ex)⁴]/Var(x)², three for normals; NaN for a constant.
    pub fn kurtosis(&self) -> f64 {
        self.count as f64 * self.m4 / (self.m2 * self.m2)
    }

    /// Whether the samples have two values only: Pearson's inequality κ ≥ 1 + (skewness)² is an
    /// equality for these and for no others.
    pub fn is_two_valued(&self) -> bool {
        let skewness = self.count as f64 * self.m3 * self.m3 / (self.m2 * self.m2 * self.m2);
        (self.kurtosis() - 1.0 - skewness).abs() <= TWO_VALUED * self.kurtosis()
    }

    /// The least and the largest sample; `None` without samples.
    pub fn range(&self) -> Option<(f64, f64)> {
        (self.count > 0).then_some((self.least, self.largest))
    }

    /// The largest distance of a sample from the mean; zero if all are the same.
    pub fn largest_deviation(&self) -> f64 {
        if self.least == self.largest {
            0.0
        } else {
            (self.largest - self.mean).max(self.mean - self.least)
        }
    }

    /// Whether the standard deviation exceeds the rounding errors of numbers of size `scale`.
    pub fn is_spread(&self, scale: f64) -> bool {
        self.variance().sqrt() > ROUND_OFF * scale
    }
}

/// Relative size of the rounding errors of sums of powers.
const TWO_VALUED: f64 = 1e-9;
/// Relative size of the rounding errors of some thousand steps.
pub const ROUND_OFF: f64 = 4096.0 * f64::EPSILON;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn merged_moments_are_those_of_all_samples() {
        // A mean of 10⁶ spreads: sums of squares would keep four digits of the variance, sums of
        // fourth powers none.
        let samples: Vec<f64> = (0..300).map(|n| 1e6 + f64::from(n * n % 97) / 97.0).collect();
        let n = samples.len() as f64;
        let mean = 1e6 + samples.iter().map(|x| x - 1e6).sum::<f64>() / n;
        let power = |k: i32| samples.iter().map(|x| (x - mean).powi(k)).sum::<f64>() / n;
        for size in [1, 7, 128, 300] {
            let mut all = CentralMoments::default();
            for group in samples.chunks(size) {
                let mut part = CentralMoments::default();
                group.iter().for_each(|&x| part.add(x));
                all.merge(&part);
            }
            assert_eq!(all.count, 300);
            assert!((all.mean() - mean).abs() < 1e-8);
            assert_eq!(all.range(), Some((1e6, 1e6 + 96.0 / 97.0)));
            assert!((all.variance() * (n - 1.0) / n / power(2) - 1.0).abs() < 1e-8, "{size}");
            assert!((all.m3 / n / power(3) - 1.0).abs() < 1e-6, "{size}");
            assert!((all.kurtosis() / (power(4) / power(2).powi(2)) - 1.0).abs() < 1e-8, "{size}");
        }
    }

    #[test]
    fn two_values_are_told_from_three() {
        let of = |value: fn(u32) -> f64| {
            let mut moments = CentralMoments::default();
            (0..100_000).for_each(|n| moments.add(value(n)));
            moments
        };
        assert!(of(|n| if n % 20_000 == 7 { 1.0 } else { 0.0 }).is_two_valued());
        assert!(
            !of(|n| if n % 20_000 == 7 { 1.0 } else { 0.01 * f64::from(n % 2) }).is_two_valued()
        );
    }

    #[test]
    fn a_constant_has_no_kurtosis_and_no_spread() {
        let mut constant = CentralMoments::default();
        for _ in 0..10 {
            constant.add(0.1);
        }
        assert!(
            constant.kurtosis().is_nan() && constant.variance() == 0.0 && !constant.is_spread(0.1)
        );
    }
}
