//! What all paths share in one step: time, step size and damping.

use std::fmt;

use real::elementary;
use systems::Damping;

/// Step number n of size τ: t_n = nτ, and the damping over it.
///
/// A damping factor is one of the two floating-point numbers next to e^{−∫γ}, and the number of the
/// step decides which: the upper one as often as the position of e^{−∫γ} between them asks, by the
/// sequence of the golden ratio. Rounded to nearest, a constant γ would have the same error in
/// every step, and n steps an error of n·ε; so it stays below log n·ε. A factor is a function of
/// the step and of nothing else, the same in a run that is resumed or computed in parts.
///
/// A factor is infinite where γ < 0 and the exact one exceeds 1.8·10³⁰⁸, and NaN where ∫γ is; the
/// step of every scheme then fails.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// t_n.
    pub t: f64,
    /// τ.
    pub tau: f64,
    /// exp(−∫γ) over the first half of the step.
    pub first_decay: f64,
    /// exp(−∫γ) over the second half of the step.
    pub second_decay: f64,
    /// γ(t_n).
    pub rate_at_start: f64,
    /// γ(t_n + τ/2).
    pub rate_at_middle: f64,
    /// γ(t_n + τ).
    pub rate_at_end: f64,
    damping_integral: f64,
}

/// Why a step was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum StepError {
    /// The step size is not a positive number.
    Size {
        /// The size that was given.
        tau: f64,
    },
}

impl fmt::Display for StepError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Size { tau } => {
                write!(f, "a step size must be positive and finite, got tau = {tau}")
            }
        }
    }
}

impl std::error::Error for StepError {}

impl Step {
    /// Step number `n` of size `tau`.
    ///
    /// # Errors
    /// [`StepError::Size`] unless 0 < τ < ∞.
    pub fn new(damping: &(impl Damping + ?Sized), n: u64, tau: f64) -> Result<Self, StepError> {
        if !(tau > 0.0 && tau.is_finite()) {
            return Err(StepError::Size { tau });
        }
        // Grid times are products and not sums, so that t_n of different step sizes agree.
        let (start, end) = (n as f64 * tau, (n as f64 + 1.0) * tau);
        let middle = (n as f64 + 0.5) * tau;
        let (first, second) = (damping.integral(start, middle), damping.integral(middle, end));
        Ok(Self {
            t: start,
            tau,
            first_decay: dithered_exp(-first, n.wrapping_mul(2)),
            second_decay: dithered_exp(-second, n.wrapping_mul(2).wrapping_add(1)),
            rate_at_start: damping.rate(start),
            rate_at_middle: damping.rate(middle),
            rate_at_end: damping.rate(end),
            damping_integral: first + second,
        })
    }

    /// ∫γ over the step.
    #[must_use]
    pub fn damping_integral(&self) -> f64 {
        self.damping_integral
    }
}

/// 2⁶⁴/φ made odd: the multiples of the golden ratio, modulo one, as 64-bit fractions. Of all
/// sequences of multiples it leaves the smallest gaps.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// One of the two numbers next to eˣ, the farther one for the fraction |remainder|/spacing of all
/// `number`s.
fn dithered_exp(x: f64, number: u64) -> f64 {
    let (nearest, remainder) = elementary::exp_with_remainder(x);
    let other = if remainder > 0.0 {
        nearest.next_up()
    } else if remainder < 0.0 {
        nearest.next_down()
    } else {
        return nearest;
    };
    let position = number.wrapping_mul(GOLDEN) as f64 / (u64::MAX as f64);
    if position * (other - nearest).abs() < remainder.abs() { other } else { nearest }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_product_of_many_equal_factors_has_no_drift() {
        for x in [-1e-3, -0.01, 1e-5, -0.3, 2.0f64.ln(), 1.7e-8, -5.0] {
            let (nearest, remainder) = elementary::exp_with_remainder(x);
            let steps = 100_000u64;
            // The sum of relative errors; each difference of neighbours is exact.
            let error: f64 =
                (0..steps).map(|n| ((dithered_exp(x, n) - nearest) - remainder) / nearest).sum();
            // The discrepancy of the sequence is below 3 log n / n.
            assert!(error.abs() < 36.0 * f64::EPSILON, "{x}: {error:e}");
            let fixed = steps as f64 * (remainder / nearest).abs();
            assert!(
                fixed > 100.0 * error.abs() || fixed < 100.0 * f64::EPSILON,
                "{x}: rounding to nearest would do"
            );
        }
    }

    #[test]
    fn extreme_factors_stay_what_they_are() {
        assert_eq!([0.0, -800.0, f64::NEG_INFINITY].map(|x| dithered_exp(x, 7)), [1.0, 0.0, 0.0]);
        assert_eq!(dithered_exp(710.0, 3), f64::INFINITY);
        assert!(dithered_exp(f64::NAN, 3).is_nan());
    }
}
