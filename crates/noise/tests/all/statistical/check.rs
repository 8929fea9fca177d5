//! Statistics against two-sided critical values. All checks of this program together fail with
//! probability at most [`FALSE_ALARM`] if everything is right (Bonferroni).

use statrs::distribution::{ContinuousCDF, Normal};

const FALSE_ALARM: f64 = 1e-4;
/// Upper bound of the number of checks: 40 in each of 20 batteries of areas and 40 others, 52 of
/// increments, and of points 27 variances, a mean, 2385 bits and 395 covariances for both keys.
const CHECKS: f64 = 6700.0;

/// What is off, if something is.
pub type Verdict = Result<(), String>;

/// The probability of a false alarm of a check, at either side.
pub fn tail() -> f64 {
    0.5 * FALSE_ALARM / CHECKS
}

/// The quantile of a standard normal.
pub fn critical() -> f64 {
    Normal::standard().inverse_cdf(1.0 - tail())
}

/// A NaN is off.
pub fn compare(statistic: f64, critical: f64) -> Verdict {
    match statistic.abs() < critical {
        true => Ok(()),
        false => Err(format!("{statistic:.1} exceeds {critical:.1}")),
    }
}

/// A sum of terms with mean zero under the hypothesis.
#[derive(Clone, Copy, Default)]
pub struct Sum {
    count: f64,
    powers: [f64; 4],
}

impl Sum {
    pub fn add(&mut self, term: f64) {
        self.count += 1.0;
        let square = term * term;
        self.powers[0] += term;
        self.powers[1] += square;
        self.powers[2] += square * term;
        self.powers[3] += square * square;
    }

    /// The sum over the root of the sum of squares, against the normal quantile with the
    /// corrections for the skewness (of a studentised sum, γ(2z² + 1)/(6√n)) and the excess of the
    /// terms that were seen.
    pub fn verdict(&self) -> Verdict {
        let [first, second, third, fourth] = self.powers;
        let n = self.count;
        let variance = second / n;
        let skewness = third / n / variance.powf(1.5);
        let excess = fourth / n / (variance * variance) - 3.0;
        let z = critical();
        let corrections = skewness.abs() * (2.0 * z * z + 1.0) / (6.0 * n.sqrt())
            + excess.abs() / n * (z * z - 3.0) * z / 24.0;
        compare(first / second.sqrt(), z + corrections)
    }
}

/// That of the sum of the terms.
pub fn of_sum(terms: impl Iterator<Item = f64>) -> Verdict {
    let mut sum = Sum::default();
    terms.for_each(|term| sum.add(term));
    sum.verdict()
}

/// √n sup|Fₙ − F|, which exceeds x with probability at most 2e^{−2x²} for every n (Massart 1990).
pub fn kolmogorov_smirnov(mut values: Vec<f64>, f: impl Fn(f64) -> f64) -> Verdict {
    values.sort_unstable_by(f64::total_cmp);
    let n = values.len() as f64;
    let distance = values.iter().enumerate().fold(0.0, |distance, (i, &x)| {
        let f = f(x);
        f64::max(distance, f64::max(f - i as f64 / n, (i + 1) as f64 / n - f))
    });
    compare(n.sqrt() * distance, (-0.5 * tail().ln()).sqrt())
}
