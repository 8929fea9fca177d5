//! A fitted order with its interval, as data.

use serde::{Deserialize, Serialize};

use crate::{moments::FEW_SAMPLES, quantile::two_sided};

/// A fitted order of convergence with a confidence interval.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Rate {
    /// Estimate of the order p.
    pub estimate: f64,
    /// Lower end of the interval.
    pub lo: f64,
    /// Upper end of the interval.
    pub hi: f64,
    /// Confidence of the interval, for example 0.95.
    pub confidence: f64,
    /// Degrees of freedom of Student's quantile behind the interval; `None` where it is the normal
    /// quantile.
    pub student_degrees: Option<f64>,
    /// The fit in words, made from the other fields.
    pub method: String,
    /// χ² of the residuals.
    pub chi_square: f64,
    /// Degrees of freedom of `chi_square`.
    pub degrees: usize,
    /// Lower end of a bootstrap interval over whole paths, of the same confidence.
    pub bootstrap_lo: Option<f64>,
    /// Upper end of the bootstrap interval.
    pub bootstrap_hi: Option<f64>,
    /// Coefficient b of the next order of the error over its standard error; `None` where b was
    /// not fitted.
    pub curvature_t: Option<f64>,
    /// The smallest effective number of paths, (Σx)²/Σx² (Kish), among the step sizes measured.
    pub effective_paths: Option<f64>,
    /// Step sizes that were left out of the fit because a few paths dominate their error.
    pub left_out: Vec<f64>,
    /// The coarsest step sizes, left out because the model does not fit with them.
    pub coarse: Vec<f64>,
    /// Probability of residuals at least as large if the model is right; `None` without degrees of
    /// freedom.
    pub p_value: Option<f64>,
    /// Reason why the interval is not known to cover the order; `None` where it is. With a
    /// `p_value` below 1e-5 no verdict is given.
    pub warning: Option<String>,
}

/// Powers of τ in a weak error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expansion {
    /// All powers from one on.
    EveryPower,
    /// Even powers two, four and so on: for means over a scheme and its adjoint.
    EvenPowers,
}

impl Expansion {
    /// First power, which is also the distance of successive powers.
    pub(crate) fn step(self) -> f64 {
        match self {
            Self::EveryPower => 1.0,
            Self::EvenPowers => 2.0,
        }
    }
}

/// Reference of a signed error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Against {
    /// Exact solution: the error is e(τ).
    Exact,
    /// Scheme with half the step: the error is e(τ) − e(τ/2). Nothing is assumed about the error
    /// that is left at the finest step. A bias that is the same at all steps leaves no trace in
    /// differences: they tell how fast a scheme converges, and not whether to the right limit.
    HalfStep,
}

/// Probability of its residuals below which a model is rejected.
///
/// Where the distribution of χ² is known, this is the share of right models that are rejected.
/// Where the covariance is estimated from a few hundred skewed squares, the tail is heavier: of
/// 20 000 sets of 400 squares of normals 1e-4 are rejected. A hundred runs with a hundred fits each
/// then lose one at most.
const REJECTED: f64 = 1e-5;

impl Rate {
    /// Whether the interval contains the order.
    pub fn covers(&self, order: f64) -> bool {
        self.lo <= order && order <= self.hi
    }

    /// Whether the residuals reject the model. The interval then has no known coverage.
    pub fn misfits(&self) -> bool {
        self.p_value.is_some_and(|p| p.is_nan() || p < REJECTED)
    }

    /// Whether a few paths carry the error at step sizes that could not be left out: the interval
    /// then reaches at each end as far as the farther of the delta method's and the bootstrap's.
    pub fn rests_on_few_paths(&self) -> bool {
        self.left_out.is_empty() && self.effective_paths.is_some_and(|paths| paths < FEW_SAMPLES)
    }

    /// Interval of another confidence: it is widened about the estimate by the ratio of the
    /// quantiles.
    pub fn interval(&self, confidence: f64) -> (f64, f64) {
        let quantile = |confidence| two_sided(confidence, self.student_degrees);
        let widening = quantile(confidence) / quantile(self.confidence);
        let reach = |end: f64| self.estimate + widening * (end - self.estimate);
        (reach(self.lo), reach(self.hi))
    }

    /// Fills in [`method`](Self::method), after the `law` that was fitted, and
    /// [`warning`](Self::warning) from the other fields: the one place that words a fit.
    pub(crate) fn described(mut self, law: &str) -> Self {
        let (chi_square, degrees) = (self.chi_square, self.degrees);
        let mut parts =
            vec![format!("{law}, χ² = {chi_square:.1} with {degrees} degrees of freedom")];
        if let Some((low, high)) = self.bootstrap_lo.zip(self.bootstrap_hi) {
            parts.push(format!("bootstrap over paths [{low:.3}, {high:.3}]"));
        }
        let few = format!("fewer than {FEW_SAMPLES} effective paths carry the error");
        let not_asymptotic = "the model does not fit with them";
        for (taus, reason) in [(&self.left_out, &few[..]), (&self.coarse, not_asymptotic)] {
            if !taus.is_empty() {
                let taus: Vec<String> = taus.iter().map(|tau| format!("{tau:.3e}")).collect();
                parts.push(format!("left out, since {reason}: τ = {}", taus.join(", ")));
            }
        }
        let mut warnings = Vec::new();
        if self.misfits() {
            warnings.push(format!(
                "the model does not fit: residuals so large have the probability {:.0e}, no order \
                 can be read off",
                self.p_value.unwrap_or(0.0)
            ));
        }
        if self.rests_on_few_paths() {
            let wider = format!("{few}: the interval is the wider of both at each end");
            parts.push(wider.clone());
            warnings.push(wider);
        }
        self.method = parts.join("; ");
        self.warning = (!warnings.is_empty()).then(|| warnings.join("; "));
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn what_was_left_out_is_listed_with_the_reason() {
        let words = |rate: Rate| rate.described("a line").method;
        let plain = words(Rate { chi_square: 1.26, degrees: 3, ..Rate::default() });
        assert_eq!(plain, "a line, χ² = 1.3 with 3 degrees of freedom");
        let all = words(Rate {
            left_out: vec![0.5, 0.25],
            effective_paths: Some(3.0),
            coarse: vec![0.125],
            bootstrap_lo: Some(0.25),
            bootstrap_hi: Some(0.5),
            ..Rate::default()
        });
        let expected = "; bootstrap over paths [0.250, 0.500]; left out, since fewer than 30 \
                        effective paths carry the error: τ = 5.000e-1, 2.500e-1; left out, since \
                        the model does not fit with them: τ = 1.250e-1";
        assert!(all.ends_with(expected), "{all}");
    }

    #[test]
    fn a_misfit_and_few_paths_are_warnings() {
        let of = |p_value, effective_paths| {
            Rate { p_value, effective_paths, ..Rate::default() }.described("")
        };
        for p_value in [None, Some(0.3), Some(1.1e-5)] {
            assert_eq!(of(p_value, Some(30.0)).warning, None);
        }
        assert!(of(Some(f64::NAN), None).misfits());
        let misfit = of(Some(9e-6), Some(100.0)).warning.unwrap();
        let words = "the model does not fit: residuals so large have the probability 9e-6";
        assert!(misfit.starts_with(words), "{misfit}");
        let few = of(None, Some(29.0));
        let wider = "fewer than 30 effective paths carry the error: the interval is the wider of \
                     both at each end";
        assert_eq!(few.warning.as_deref(), Some(wider));
        assert!(few.method.ends_with(&format!("; {wider}")));
        assert_eq!(of(Some(9e-6), Some(29.0)).warning, Some(format!("{misfit}; {wider}")));
        assert!(!Rate { left_out: vec![0.5], ..few }.rests_on_few_paths());
    }
}
