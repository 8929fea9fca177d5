//! Curves of a figure as data: errors against step sizes, invariants in time, costs.

use serde::Serialize;
use stats::{Point, Rate};

/// Kind of the curves of a figure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Root-mean-square error against the step size.
    #[default]
    Strong,
    /// Signed weak error against the step size.
    Weak,
    /// An invariant along one path, with its conformal law.
    Invariant,
    /// Path-steps against the accuracy of an expectation.
    Cost,
}

/// Curve of one scheme and one quantity.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Series {
    /// Identifier of the scheme.
    pub scheme: String,
    /// Measured quantity: `y(T)`, `sup y` (strong; at the common coarse time where the coarsest
    /// step's error is largest, found on other paths), `y1`, `y2^2`, `cos y3` (weak), `C`, `H`
    /// (invariant).
    pub quantity: String,
    /// The points, in the order of decreasing step size, or of time.
    pub points: Vec<Point>,
    /// Fitted order, for strong and weak panels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate: Option<Rate>,
    /// Largest relative defect of the conformal law along the path, for invariant panels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_relative_defect: Option<f64>,
}

/// Two-sided 95 % quantile of the normal distribution.
pub const QUANTILE: f64 = 1.96;

/// Quantity that a strong or invariant figure shows: the error at the final time, or else the first
/// quantity.
pub fn main_quantity(series: &[Series]) -> &str {
    let at_end = series.iter().find(|series| series.quantity == "y(T)");
    at_end.or(series.first()).map_or("", |series| &series.quantity)
}

/// Relative defect |value − exact| / |exact|; zero where the two agree.
pub fn relative_defect(value: f64, exact: f64) -> f64 {
    if value == exact { 0.0 } else { ((value - exact) / exact).abs() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agreement_has_no_defect_even_at_zero() {
        assert_eq!(relative_defect(0.0, 0.0), 0.0);
        assert_eq!(relative_defect(1.5, -1.0), 2.5);
        assert_eq!(relative_defect(1.0, 0.0), f64::INFINITY);
    }
}
