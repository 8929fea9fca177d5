//! One point of a curve, as data.

use serde::{Deserialize, Serialize};

/// One point of a curve.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Point {
    /// A measured error at a step size, with its standard error.
    Error {
        /// Step size.
        tau: f64,
        /// Root-mean-square error (strong) or signed weak error (weak).
        value: f64,
        /// Standard error of `value`.
        se: f64,
        /// Lower end of a 95 % interval that allows for skewed errors, for strong points; `None`
        /// where `value` ± 1.96 `se` is the interval.
        lo: Option<f64>,
        /// Upper end of the interval.
        hi: Option<f64>,
        /// Reason why no interval is reliable here; `None` where one is.
        warning: Option<String>,
    },
    /// Cost of an accuracy.
    Cost {
        /// Half-width of the 95 % interval that was asked for.
        accuracy: f64,
        /// Number of path-steps for this accuracy.
        path_steps: u64,
    },
    /// A value along a path.
    Value {
        /// Time.
        t: f64,
        /// Value of the invariant on the numerical path.
        value: f64,
        /// Value exp(−p ∫₀ᵗ γ) F(y₀) of the conformal law.
        exact: f64,
    },
}

impl Point {
    /// Creates an error whose estimate is normal: `value` ± 1.96 `se` is its 95 % interval.
    pub fn normal(tau: f64, value: f64, se: f64) -> Self {
        Self::Error { tau, value, se, lo: None, hi: None, warning: None }
    }

    /// Whether the interval of a measured error contains the true one: [`lo`, `hi`] where there is
    /// one, else `value` ± 1.96 `se`.
    pub fn covers(&self, truth: f64) -> bool {
        let Self::Error { value, se, lo, hi, .. } = *self else { return false };
        let (lo, hi) = lo.zip(hi).unwrap_or((value - 1.96 * se, value + 1.96 * se));
        lo <= truth && truth <= hi
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_covers_by_its_interval_or_by_its_standard_error() {
        let (lo, hi) = (Some(1.5), Some(4.0));
        let skewed = Point::Error { tau: 0.1, value: 2.0, se: 0.5, lo, hi, warning: None };
        // 2 ± 0.98.
        for (point, (a, b)) in [(skewed, (1.5, 4.0)), (Point::normal(0.1, 2.0, 0.5), (1.02, 2.98))]
        {
            let covered = [a - 0.01, a + 0.01, b - 0.01, b + 0.01].map(|truth| point.covers(truth));
            assert_eq!(covered, [false, true, true, false]);
        }
        assert!(!Point::Cost { accuracy: 2.0, path_steps: 2 }.covers(2.0));
    }
}
