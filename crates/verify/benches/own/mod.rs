//! The rigid body with three noises as somebody else might write it: what the generic trait costs
//! beside the tuned system.

use real::Real;
use systems::{ImplicitStep, PoissonSystem};

/// 1/Iᵢ and 1/Îᵢ of the paper's body.
const DRIFT: [f64; 3] = [0.5, 1.0, 1.5];
const NOISE: [f64; 3] = [1.0, 0.5, 1.0 / 3.0];

#[inline(always)]
fn cross<R: Real>(y: [R; 3], v: [R; 3]) -> [R; 3] {
    [y[1] * v[2] - y[2] * v[1], y[2] * v[0] - y[0] * v[2], y[0] * v[1] - y[1] * v[0]]
}

/// Only what must be said: eight nodes, with gradients by dual numbers at each.
pub struct TwoFormulas;

impl PoissonSystem<3, 3> for TwoFormulas {
    fn name(&self) -> &'static str {
        "two formulas"
    }
    #[inline(always)]
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        cross(y, v)
    }
    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 3]) -> R {
        let mut sum = R::zero();
        for i in 0..3 {
            sum = sum + y[i] * y[i] * (0.5 * (dt * DRIFT[i] + dw[i] * NOISE[i]));
        }
        sum
    }
}

/// With the gradient and its average as closed forms, and the first sweep written out.
pub struct TwentyLines;

impl PoissonSystem<3, 3> for TwentyLines {
    const IMPLICIT_STEP: ImplicitStep = ImplicitStep::UnrolledFixedPoint;
    fn name(&self) -> &'static str {
        "twenty lines"
    }
    #[inline(always)]
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        cross(y, v)
    }
    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 3]) -> R {
        let v = self.gradient(y, dt, dw);
        (y[0] * v[0] + y[1] * v[1] + y[2] * v[2]) * 0.5
    }
    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 3]) -> [R; 3] {
        let mut v = y;
        for i in 0..3 {
            v[i] = y[i] * (dt * DRIFT[i] + dw[i] * NOISE[i]);
        }
        v
    }
    #[inline(always)]
    fn averaged_gradient<R: Real>(&self, a: [R; 3], b: [R; 3], dt: f64, dw: [f64; 3]) -> [R; 3] {
        self.gradient(dgrad::midpoint(a, b), dt, dw)
    }
}
