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
        /// Lower end of a 95 % interval that allows for skewed errors, of strong points; elsewhere
        /// `value` ± 1.96 `se` is one.
        #[serde(skip_serializing_if = "Option::is_none")]
        lo: Option<f64>,
        /// Its upper end.
        #[serde(skip_serializing_if = "Option::is_none")]
        hi: Option<f64>,
        /// Why no interval can be trusted here; absent where one can.
        #[serde(skip_serializing_if = "Option::is_none")]
        warning: Option<String>,
    },
    /// What an accuracy costs.
    Cost {
        /// Half-width of the 95 % interval that was asked for.
        accuracy: f64,
        /// Path-steps that it took.
        path_steps: u64,
    },
    /// A value along a path.
    Value {
        /// Time.
        t: f64,
        /// Value of the invariant on the numerical path.
        value: f64,
        /// What the conformal law exp(−p ∫₀ᵗ γ) F(y₀) asks for.
        exact: f64,
    },
}

impl Point {
    /// An error whose estimate is normal: `value` ± 1.96 `se` is its 95 % interval.
    pub fn normal(tau: f64, value: f64, se: f64) -> Self {
        Self::Error { tau, value, se, lo: None, hi: None, warning: None }
    }
}
