//! Time, step size and damping of one step, shared by all paths.

use noise::GOLDEN;
use real::elementary;
use systems::Damping;

/// Step number n of size τ from t_n = nτ, with the damping over it.
///
/// exp(−∫γ) is rounded by deterministic dithering, so rounding bias does not accumulate. A damping
/// factor is one of the two floating-point numbers next to exp(−∫γ). A golden-ratio sequence in n
/// chooses between them, with frequencies such that the mean is exact. The error after n steps is
/// of order ε·log n. Rounding to nearest would give the same error in every step for a constant γ,
/// and n·ε after n steps. A factor depends on n, τ and γ alone, so it is the same in a resumed run.
///
/// A factor is infinite if γ < 0 and exp(−∫γ) exceeds 1.8·10³⁰⁸, and NaN if ∫γ is NaN. The step of
/// every scheme then fails.
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

/// A step size that is not positive and finite.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("a step size must be positive and finite, got tau = {tau}")]
pub struct StepError {
    /// The given size.
    pub tau: f64,
}

impl Step {
    /// Step number `n` of size `tau`.
    ///
    /// # Errors
    /// [`StepError`] unless 0 < τ < ∞.
    pub fn new(damping: &dyn Damping, n: u64, tau: f64) -> Result<Self, StepError> {
        if !(tau > 0.0 && tau.is_finite()) {
            return Err(StepError { tau });
        }
        let (first, first_decay) = over_half(damping, tau, n, 0);
        let (second, second_decay) = over_half(damping, tau, n, 1);
        let rate = |part: f64| damping.rate((n as f64 + part) * tau);
        Ok(Self {
            t: n as f64 * tau,
            tau,
            first_decay,
            second_decay,
            rate_at_start: rate(0.0),
            rate_at_middle: rate(0.5),
            rate_at_end: rate(1.0),
            damping_integral: first + second,
        })
    }

    /// exp(−∫γ) of another damping over a half of the step: 0 is the first, 1 the second. It is
    /// dithered like the factors of the step.
    pub fn decay(&self, damping: &dyn Damping, half: u64) -> f64 {
        over_half(damping, self.tau, self.number(), half).1
    }

    /// A step of size `tau`, which may be negative, about the middle of this one, without damping.
    pub(crate) fn undamped(&self, tau: f64) -> Self {
        Self {
            t: self.t + 0.5 * (self.tau - tau),
            tau,
            first_decay: 1.0,
            second_decay: 1.0,
            rate_at_start: 0.0,
            rate_at_middle: 0.0,
            rate_at_end: 0.0,
            damping_integral: 0.0,
        }
    }

    /// The number n of the step.
    pub fn number(&self) -> u64 {
        (self.t / self.tau).round() as u64
    }

    /// ∫γ over the step.
    pub fn damping_integral(&self) -> f64 {
        self.damping_integral
    }
}

/// ∫γ and exp(−∫γ), dithered, over a half of step number n of size `tau`: 0 is the first, 1 the
/// second.
fn over_half(damping: &dyn Damping, tau: f64, n: u64, half: u64) -> (f64, f64) {
    // Times are products, not sums, so that t_n agrees for different step sizes.
    let time = |halves: u64| (n as f64 + 0.5 * halves as f64) * tau;
    let integral = damping.integral(time(half), time(half + 1));
    (integral, dithered_exp(-integral, n.wrapping_mul(2).wrapping_add(half)))
}

/// One of the two floating-point numbers next to eˣ. A fraction |remainder|/spacing of all
/// `number`s gives the farther one.
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
            // The sum of relative errors. Differences of adjacent numbers are exact.
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
