//! The damped stochastic mathematical pendulum (paper, Example 1).

use dgrad::{ShortMean, mean_sine};
use real::Real;

use crate::error::finite;
use crate::{PoissonSystem, SystemError};

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
    const PREFERS_NEWTON: bool = true;

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

    /// The change h of the angle satisfies h = w(a₁ − ½w·mean sine), which three iterations solve.
    #[inline(always)]
    fn predictor(&self, a: [f64; 2], dt: f64, dw: [f64; 1]) -> [f64; 2] {
        let weight = dt + self.noise * dw[0];
        let (drift, half) = (weight * a[0], 0.5 * weight);
        let force = ShortMean::of_sine(a[1], weight);
        let change = drift - half * force.quadratic(drift);
        let change = drift - half * force.cubic(change);
        [a[0] - force.cubic(change), a[1] + change]
    }

    #[inline(always)]
    fn averaged_field_near(&self, a: [f64; 2], b: [f64; 2], dt: f64, dw: [f64; 1]) -> [f64; 2] {
        let weight = dt + self.noise * dw[0];
        [-ShortMean::of_sine(a[1], weight).value(b[1] - a[1]), (a[0] + b[0]) * (0.5 * weight)]
    }

    #[inline(always)]
    fn averaged_field_jacobian_near(
        &self,
        a: [f64; 2],
        b: [f64; 2],
        dt: f64,
        dw: [f64; 1],
    ) -> ([f64; 2], [[f64; 2]; 2]) {
        let weight = dt + self.noise * dw[0];
        let (mean, slope) = ShortMean::of_sine(a[1], weight).with_slope(b[1] - a[1]);
        ([-mean, (a[0] + b[0]) * (0.5 * weight)], [[0.0, -slope], [0.5 * weight, 0.0]])
    }
}
