//! The damped three-dimensional Poisson system with constant structure (paper, Example 5).

use dgrad::{ShortMean, mean_cosine};
use real::Real;

use crate::error::finite;
use crate::{Form, Invariant, InvariantKind, PoissonSystem, SystemError};

/// B v = (v₂ − v₃, −v₁ + v₃, v₁ − v₂), H = sin y₁ + sin y₂ + sin y₃, one noise cH.
///
/// Casimirs s = y₁ + y₂ + y₃ of degree 1 and ½s² of degree 2.
#[derive(Clone, Copy, Debug)]
pub struct Poisson3 {
    noise: f64,
}

impl Poisson3 {
    /// Noise of size c.
    ///
    /// # Errors
    /// [`SystemError::NonFiniteParameter`].
    pub fn new(c: f64) -> Result<Self, SystemError> {
        Ok(Self { noise: finite("the noise size c", c)? })
    }
}

impl Poisson3 {
    /// The averages of the three cosines from a, times dt + c dw.
    #[inline(always)]
    fn means(&self, a: [f64; 3], dt: f64, dw: [f64; 1]) -> [ShortMean; 3] {
        let weight = dt + self.noise * dw[0];
        [ShortMean::of_cosine(a[0], weight), ShortMean::of_cosine(a[1], weight), ShortMean::of_cosine(a[2], weight)]
    }
}

impl PoissonSystem<3, 1> for Poisson3 {
    const PREFERS_NEWTON: bool = true;

    fn name(&self) -> &'static str {
        "poisson3"
    }

    #[inline(always)]
    fn structure<R: Real>(&self, _y: [R; 3], v: [R; 3]) -> [R; 3] {
        rotated(v)
    }

    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> R {
        (y[0].sin() + y[1].sin() + y[2].sin()) * (dt + self.noise * dw[0])
    }

    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> [R; 3] {
        let weight = dt + self.noise * dw[0];
        [y[0].cos() * weight, y[1].cos() * weight, y[2].cos() * weight]
    }

    #[inline(always)]
    fn averaged_gradient<R: Real>(&self, a: [R; 3], b: [R; 3], dt: f64, dw: [f64; 1]) -> [R; 3] {
        let weight = dt + self.noise * dw[0];
        [mean_cosine(a[0], b[0]) * weight, mean_cosine(a[1], b[1]) * weight, mean_cosine(a[2], b[2]) * weight]
    }

    /// Six fixed-point iterations with Taylor polynomials for the averages.
    #[inline(always)]
    fn predictor(&self, a: [f64; 3], dt: f64, dw: [f64; 1]) -> [f64; 3] {
        let means = self.means(a, dt, dw);
        let change = rotated([means[0].constant(), means[1].constant(), means[2].constant()]);
        let change = rotated(quadratic(&means, change));
        let change = rotated(quadratic(&means, change));
        let change = rotated(cubic(&means, change));
        let change = rotated(cubic(&means, change));
        let change = rotated(cubic(&means, change));
        [a[0] + change[0], a[1] + change[1], a[2] + change[2]]
    }

    #[inline(always)]
    fn averaged_field_near(&self, a: [f64; 3], b: [f64; 3], dt: f64, dw: [f64; 1]) -> [f64; 3] {
        let means = self.means(a, dt, dw);
        rotated([means[0].value(b[0] - a[0]), means[1].value(b[1] - a[1]), means[2].value(b[2] - a[2])])
    }

    #[inline(always)]
    fn averaged_field_jacobian_near(
        &self,
        a: [f64; 3],
        b: [f64; 3],
        dt: f64,
        dw: [f64; 1],
    ) -> ([f64; 3], [[f64; 3]; 3]) {
        let means = self.means(a, dt, dw);
        let (v0, s0) = means[0].with_slope(b[0] - a[0]);
        let (v1, s1) = means[1].with_slope(b[1] - a[1]);
        let (v2, s2) = means[2].with_slope(b[2] - a[2]);
        (rotated([v0, v1, v2]), [[0.0, s1, -s2], [-s0, 0.0, s2], [s0, -s1, 0.0]])
    }

    fn invariants(&self) -> Vec<Invariant> {
        let casimir = Invariant {
            name: "C",
            formula: "½(y₁ + y₂ + y₃)²",
            kind: InvariantKind::Casimir,
            form: Form::Quadratic,
            degree: 2.0,
        };
        vec![casimir, Invariant { name: "S", formula: "y₁ + y₂ + y₃", form: Form::Linear, degree: 1.0, ..casimir }]
    }

    #[inline(always)]
    fn invariant<R: Real>(&self, index: usize, y: [R; 3]) -> R {
        let sum = y[0] + y[1] + y[2];
        if index == 0 { sum * sum * 0.5 } else { sum }
    }
}

/// B v.
#[inline(always)]
fn rotated<R: Real>(v: [R; 3]) -> [R; 3] {
    [v[1] - v[2], v[2] - v[0], v[0] - v[1]]
}

#[inline(always)]
fn quadratic(means: &[ShortMean; 3], change: [f64; 3]) -> [f64; 3] {
    [means[0].quadratic(change[0]), means[1].quadratic(change[1]), means[2].quadratic(change[2])]
}

#[inline(always)]
fn cubic(means: &[ShortMean; 3], change: [f64; 3]) -> [f64; 3] {
    [means[0].cubic(change[0]), means[1].cubic(change[1]), means[2].cubic(change[2])]
}
