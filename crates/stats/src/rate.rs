//! A fitted order with its interval, as data.

use serde::{Deserialize, Serialize};

use crate::{moments::FEW_SAMPLES, quantile::two_sided};

/// A fitted order of convergence with a confidence interval.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Rate {
    /// The order p.
    pub estimate: f64,
    /// Lower end of the interval.
    pub lo: f64,
    /// Upper end of the interval.
    pub hi: f64,
    /// Confidence of the interval, for example 0.95.
    pub confidence: f64,
    /// Degrees of freedom of Student's quantile behind the interval; absent where it is the normal
    /// one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub student_degrees: Option<f64>,
    /// The fit in words, made from the other fields.
    pub method: String,
    /// What was fitted.
    #[serde(default)]
    pub model: Model,
    /// χ² of the residuals.
    #[serde(default)]
    pub chi_square: f64,
    /// Its degrees of freedom.
    #[serde(default)]
    pub degrees: usize,
    /// Lower end of a bootstrap interval over whole paths, of the same confidence.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bootstrap_lo: Option<f64>,
    /// Its upper end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bootstrap_hi: Option<f64>,
    /// A straight line through the same points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub straight: Option<StraightLine>,
    /// Coefficient b of the next order of the error over its standard error; absent where it was
    /// not fitted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub curvature_t: Option<f64>,
    /// The smallest effective number of paths, (Σx)²/Σx² (Kish), among the step sizes measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub effective_paths: Option<f64>,
    /// Step sizes that were left out of the fit because a few paths dominate their error.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub left_out: Vec<f64>,
    /// The coarsest step sizes, left out because the model does not fit with them.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub coarse: Vec<f64>,
    /// The probability of residuals as large as these if the model is right; absent without
    /// degrees of freedom.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p_value: Option<f64>,
    /// Why the interval is not known to cover the order; absent where it is. With a `p_value` below
    /// 1e-5 no verdict is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub warning: Option<String>,
}

/// What a fit of an order takes for the law of the errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// Mean squares m that share paths: ln m = a + 2p ln τ + ln(1 + bτ), with b where
    /// [`Rate::curvature_t`] is present.
    #[default]
    MeanSquares,
    /// Independent positive errors: ln e = a + p ln τ + bτ + cτ².
    Logarithms,
    /// Signed errors: e(τ) = Aτᵖ + Bτ^{p+1} + …, with this many terms, or with every second power.
    Powers {
        /// What the errors are measured against.
        against: Against,
        /// Number of terms.
        terms: u32,
        /// Which powers follow the first.
        #[serde(default, skip_serializing_if = "Expansion::has_every_power")]
        expansion: Expansion,
    },
}

/// The powers of τ in a weak error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Expansion {
    /// All from one on.
    #[default]
    EveryPower,
    /// Two, four and so on: of means over a scheme and its adjoint.
    EvenPowers,
}

impl Expansion {
    /// The first power, and from one to the next.
    pub(crate) fn step(self) -> f64 {
        match self {
            Self::EveryPower => 1.0,
            Self::EvenPowers => 2.0,
        }
    }

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
    fn has_every_power(&self) -> bool {
        *self == Self::EveryPower
    }
}

/// What a signed error is measured against.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Against {
    /// The exact solution: e(τ).
    Exact,
    /// The same scheme with half the step: e(τ) − e(τ/2). Nothing is assumed about the error that
    /// is left at the finest step. A bias that is the same at all steps leaves no trace in
    /// differences: they tell how fast a scheme converges, and not whether to the right limit.
    HalfStep,
}

/// A straight line through the points of a log–log plot, and whether the points lie on one.
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
    /// Whether χ² is beyond the 99 % quantile of Hotelling's T²: the points lie on no line.
    pub refuted: bool,
}

/// Confidence at which a straight line is refuted.
pub const STRAIGHT_CONFIDENCE: f64 = 0.99;

/// Below this probability of its residuals a model is rejected.
///
/// Where the distribution of χ² is known, this is the share of right models that are rejected.
/// Where the covariance is estimated from a few hundred skewed squares, the tail is heavier: of
/// 20 000 sets of 400 squares of normals 1e-4 are rejected. A hundred runs with a hundred fits each
/// then lose one at most.
const REJECTED: f64 = 1e-5;

impl Rate {
    /// Whether the residuals reject the model. The interval then has no known coverage.
    pub fn misfits(&self) -> bool {
        self.p_value.is_some_and(|p| p.is_nan() || p < REJECTED)
    }

    /// Whether a few paths carry the error at step sizes that could not be left out: the interval
    /// then reaches at each end as far as the farther of the delta method's and the bootstrap's.
    pub fn rests_on_few_paths(&self) -> bool {
        self.left_out.is_empty() && self.effective_paths.is_some_and(|paths| paths < FEW_SAMPLES)
    }

    /// The interval, widened about the estimate to another confidence by the ratio of the
    /// quantiles.
    pub fn interval(&self, confidence: f64) -> (f64, f64) {
        let quantile = |confidence| two_sided(confidence, self.student_degrees);
        let widening = quantile(confidence) / quantile(self.confidence);
        let reach = |end: f64| self.estimate + widening * (end - self.estimate);
        (reach(self.lo), reach(self.hi))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_is_rejected_below_one_in_a_hundred_thousand() {
        let misfits = |p_value| Rate { p_value, ..Rate::default() }.misfits();
        let p = [None, Some(0.5), Some(1.1e-5), Some(0.9e-5), Some(f64::NAN)];
        assert_eq!(p.map(misfits), [false, false, false, true, true]);
    }

    #[test]
    fn few_paths_carry_the_error_unless_their_levels_are_left_out() {
        let few = |effective_paths, left_out: &[f64]| {
            Rate { effective_paths, left_out: left_out.to_vec(), ..Rate::default() }
                .rests_on_few_paths()
        };
        assert!(few(Some(29.0), &[]) && !few(Some(30.0), &[]));
        assert!(!few(Some(29.0), &[0.5]) && !few(None, &[]));
    }

    #[test]
    fn another_confidence_widens_both_ends_about_the_estimate() {
        let rate = Rate { estimate: 1.0, lo: 0.8, hi: 1.1, confidence: 0.95, ..Rate::default() };
        // Normal quantiles of 95 % and 99 %, and those of Student with ten degrees of freedom.
        for (student_degrees, ratio) in [
            (None, 2.575_829_303_5 / 1.959_963_984_5),
            (Some(10.0), 3.169_272_672_6 / 2.228_138_852_0),
        ] {
            let rate = Rate { student_degrees, ..rate.clone() };
            let (lo, hi) = rate.interval(0.99);
            assert!((lo - (1.0 - 0.2 * ratio)).abs() < 1e-8, "{lo}");
            assert!((hi - (1.0 + 0.1 * ratio)).abs() < 1e-8, "{hi}");
            let (lo, hi) = rate.interval(0.95);
            assert!((lo - 0.8).abs() < 1e-15 && (hi - 1.1).abs() < 1e-15);
        }
    }
}
