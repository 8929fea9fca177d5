//! One point of a curve, and root-mean-squares as points.

use serde::{Deserialize, Serialize};

use crate::CrossMoments;
use crate::order::{FEW_PATHS, root_mean_square_interval};

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
        #[serde(skip_serializing_if = "Option::is_none", default)]
        lo: Option<f64>,
        /// Its upper end.
        #[serde(skip_serializing_if = "Option::is_none", default)]
        hi: Option<f64>,
        /// Why no interval can be trusted here; absent where one can.
        #[serde(skip_serializing_if = "Option::is_none", default)]
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
    #[must_use]
    pub fn normal(tau: f64, value: f64, se: f64) -> Self {
        Self::Error { tau, value, se, lo: None, hi: None, warning: None }
    }
}

/// The points of a curve, with bootstrap-t intervals for the root-mean-squares and a warning where
/// a few paths carry one.
#[must_use]
pub fn root_mean_squares(taus: &[f64], squares: &CrossMoments) -> Vec<Point> {
    taus.iter().enumerate().filter_map(|(l, &tau)| root_mean_square(tau, l, squares)).collect()
}

/// √mean with its standard error by the delta method; nothing without samples.
fn root_mean_square(tau: f64, l: usize, squares: &CrossMoments) -> Option<Point> {
    let value = squares.mean(l).sqrt();
    let se_of_square = squares.covariance_of_means(l, l).sqrt();
    let se = if value > 0.0 { se_of_square / (2.0 * value) } else { 0.0 };
    if !(value.is_finite() && se.is_finite()) {
        return None;
    }
    let effective = squares.effective_samples(l);
    let warning = (effective < FEW_PATHS).then(|| {
        format!(
            "only {effective:.0} effective paths carry the error; the interval may be too narrow"
        )
    });
    let (lo, hi) = root_mean_square_interval(squares, l).unzip();
    Some(Point::Error { tau, value, se, lo, hi, warning })
}
