//! The damped stochastic mathematical pendulum (paper, Example 1).

use dgrad::{ShortMean, mean_sine};
use real::Real;

use crate::error::finite;
use crate::{ImplicitStep, PoissonSystem, SystemError};

/// B(y)v = (−v₂, v₁), H = ½y₁² − cos y₂, one noise cH: y₁ is the momentum, y₂ the angle.
///
/// No Casimir, and H is not homogeneous: nothing is damped conformally.
#[derive(Clone, Copy, Debug)]
pub struct Pendulum {
    noise: f64,
}

impl Pendulum {
    /// Noise of size c.
    ///
    /// # Errors
    /// [`SystemError::NonFiniteParameter`].
    pub fn new(c: f64) -> Result<Self, SystemError> {
        Ok(Self { noise: finite("the noise size c", c)? })
    }
}

impl PoissonSystem<2, 1> for Pendulum {
    fn name(&self) -> &'static str {
        "pendulum"
    }

    #[inline(always)]
    fn structure<R: Real>(&self, _y: [R; 2], v: [R; 2]) -> [R; 2] {
        [-v[1], v[0]]
    }

    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; 1]) -> R {
        (y[0] * y[0] * 0.5 - y[1].cos()) * (dt + self.noise * dw[0])
    }

    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; 1]) -> [R; 2] {
        let weight = dt + self.noise * dw[0];
        [y[0] * weight, y[1].sin() * weight]
    }

    #[inline(always)]
    fn averaged_gradient<R: Real>(&self, a: [R; 2], b: [R; 2], dt: f64, dw: [f64; 1]) -> [R; 2] {
        let weight = dt + self.noise * dw[0];
        [(a[0] + b[0]) * (0.5 * weight), mean_sine(a[1], b[1]) * weight]
    }

    /// Newton's method for the change h of the angle, f(h) = h − w(a₁ − ½M(h)) = 0 with the average
    /// force M(h): after two iterations with polynomials a step δ₁ with the derivative to seven
    /// digits, and one δ that keeps it.
    ///
    /// The force after δ is the one before with that derivative, so that f = 0 and what is left is
    /// in the momentum: M″ is at most |w|/3 and the derivative lacks at most 2.3·10⁻⁸|w|, hence ‖z
    /// − ψ(z)‖₁ ≤ |w|(⅓(|δ₁| + |δ|) + 3·10⁻⁸)|δ|. For |w| < 1 the map contracts, and there is no
    /// other solution.
    #[inline(always)]
    fn predict(&self, a: [f64; 2], dt: f64, dw: [f64; 1]) -> ([f64; 2], f64) {
        let weight = dt + self.noise * dw[0];
        let (drift, half) = (weight * a[0], 0.5 * weight);
        let force = ShortMean::of_sine(a[1], weight);
        let h = drift - half * force.quadratic(drift);
        let h = drift - half * force.cubic(h);
        let (mean, slope) = force.estimate_with_slope(h);
        let inverse = 1.0 / (1.0 + half * slope);
        let first = ((h - drift) + half * mean) * inverse;
        let h = h - first;
        let mean = force.value(h);
        let last = ((h - drift) + half * mean) * inverse;
        let bound = (weight.abs() * last.abs()) * ((first.abs() + last.abs()) * (1.0 / 3.0) + 3e-8);
        let bound = if weight.abs() < 1.0 { bound } else { f64::INFINITY };
        ([a[0] - (mean - slope * last), a[1] + (h - last)], bound)
    }

    const IMPLICIT_STEP: ImplicitStep = ImplicitStep::Predicted;
}
