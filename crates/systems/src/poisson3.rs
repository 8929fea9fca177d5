//! The damped three-dimensional Poisson system with constant structure (paper, Example 5).

use dgrad::mean_cosine;
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

impl PoissonSystem<3, 1> for Poisson3 {
    fn name(&self) -> &'static str {
        "poisson3"
    }

    #[inline(always)]
    fn structure<R: Real>(&self, _y: [R; 3], v: [R; 3]) -> [R; 3] {
        [v[1] - v[2], v[2] - v[0], v[0] - v[1]]
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
