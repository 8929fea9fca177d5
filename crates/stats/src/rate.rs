//! What a fit of an order says.

use serde::{Deserialize, Serialize};

/// A fitted convergence order with a confidence interval.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Rate {
    /// The order.
    pub estimate: f64,
    /// Lower end of the interval.
    pub lo: f64,
    /// Upper end of the interval.
    pub hi: f64,
    /// Confidence of the interval, for example 0.95.
    pub confidence: f64,
    /// Degrees of freedom of Student's quantile behind the interval; absent where it is the normal
    /// one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub student_degrees: Option<f64>,
    /// How it was fitted, in words, with the goodness of fit.
    pub method: String,
    /// Lower end of a bootstrap interval over whole paths, of the same confidence.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub bootstrap_lo: Option<f64>,
    /// Its upper end.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub bootstrap_hi: Option<f64>,
    /// What a straight line through the same points would say.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub straight: Option<StraightLine>,
    /// Coefficient of the next order of the error over its standard error, when it was fitted.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub curvature_t: Option<f64>,
    /// Coefficient of the reference's error over its standard error, when it was fitted.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub reference_t: Option<f64>,
    /// The smallest effective number of paths, (Σx)²/Σx², among the step sizes measured.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub effective_paths: Option<f64>,
    /// Step sizes that were left out of the fit because a few paths dominate their error.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub left_out: Vec<f64>,
    /// The probability of residuals as large as these when the model is right; absent without
    /// degrees of freedom.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub p_value: Option<f64>,
    /// Why the interval is not known to cover the order; absent where it is. With a `p_value` below
    /// 1e-5 no verdict is given.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub warning: Option<String>,
}

/// A straight line through the points of a log-log plot, and whether the points lie on one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StraightLine {
    /// Its slope, as an order.
    pub estimate: f64,
    /// Lower end of the slope's interval, which is right only if the points lie on a line.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
    /// χ² of the points about the line.
    pub chi_square: f64,
    /// Its degrees of freedom.
    pub degrees: u32,
    /// Whether it is refuted as the law of the points, by the rule in `docs/results.md`.
    pub refuted: bool,
}
