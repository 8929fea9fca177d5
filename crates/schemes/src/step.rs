//! What all paths share in one step: time, step size and damping.

use std::fmt;

use real::elementary;
use systems::Damping;

/// Step number n of size τ: t_n = nτ, and the damping over it.
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
            Self::Size { tau } => write!(f, "a step size must be positive and finite, got tau = {tau}"),
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
            first_decay: elementary::exp(-first),
            second_decay: elementary::exp(-second),
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
