//! The damped stochastic mathematical pendulum.

use dgrad::{ShortMean, mean_sine};
use real::Real;

use crate::{Flows, ImplicitStep, PoissonSystem, SystemError, error::finite};

/// The mathematical pendulum (Bréhier, Cohen and Komori 2025, Example 1): B(y)v = (−v₂, v₁),
/// H₀ = H = ½y₁² − cos y₂ and H₁ = cH, with the momentum y₁ and the angle y₂ in radians.
///
/// There is no Casimir and H is not homogeneous, so no function obeys the conformal law.
#[derive(Clone, Copy, Debug)]
pub struct Pendulum {
    noise: f64,
}

impl Pendulum {
    /// The pendulum with noise of size c.
    ///
    /// # Errors
    /// [`SystemError`] unless c is finite.
    pub fn new(c: f64) -> Result<Self, SystemError> {
        Ok(Self { noise: finite("the noise size c", c)? })
    }
}

/// Parts: ½y₁², which moves the angle, then −cos y₂, which moves the momentum: one sine a step.
impl Flows<2, 1> for Pendulum {
    const PARTS: usize = 2;
    const EXACT: bool = true;

    #[inline(always)]
    fn flow<R: Real>(&self, part: usize, y: [R; 2], dt: R, dw: [R; 1]) -> [R; 2] {
        let time = dt + dw[0] * self.noise;
        match part {
            0 => [y[0], y[1] + time * y[0]],
            _ => [y[0] - time * y[1].sin(), y[1]],
        }
    }
}

impl PoissonSystem<2, 1> for Pendulum {
    fn name(&self) -> &'static str {
        "pendulum"
    }

    fn parameters(&self) -> String {
        format!("c = {}", self.noise)
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

    /// Newton's method for the change h of the angle: f(h) = h − w(a₁ − ½M(h)) = 0, where w is the
    /// weight of H and M(h) the average force. Two iterations use polynomials for M. Then follow a
    /// Newton step δ₁ with M′ to seven digits, and a simplified step δ with the same derivative.
    ///
    /// The force after δ is extrapolated with this derivative. Then f = 0, and only the momentum
    /// has a residual. Since |M″| ≤ |w|/3 and the error of M′ is at most 2.3·10⁻⁸|w|, ‖z − ψ(z)‖₁ ≤
    /// |w|(⅓(|δ₁| + |δ|) + 3·10⁻⁸)|δ|. For |w| < 1 the map contracts, so the solution is unique.
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
