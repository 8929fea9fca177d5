//! The damped three-dimensional Poisson system with constant structure (paper, Example 5).

use dgrad::{ShortMean, mean_cosine};
use real::Real;

use crate::error::finite;
use crate::system::no_invariant;
use crate::{Form, ImplicitStep, Invariant, InvariantKind, PoissonSystem, SystemError};

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
    /// The averages of the three cosines from a, times a weight.
    #[inline(always)]
    fn means(&self, a: [f64; 3], weight: f64) -> [ShortMean; 3] {
        [
            ShortMean::of_cosine(a[0], weight),
            ShortMean::of_cosine(a[1], weight),
            ShortMean::of_cosine(a[2], weight),
        ]
    }
}

impl PoissonSystem<3, 1> for Poisson3 {
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
        [
            mean_cosine(a[0], b[0]) * weight,
            mean_cosine(a[1], b[1]) * weight,
            mean_cosine(a[2], b[2]) * weight,
        ]
    }

    /// Newton's method for the changes h = b − a, whose sum is zero: two unknowns. On cubic
    /// polynomials first, then a step with the derivatives to seven digits, and one that keeps its
    /// matrix.
    ///
    /// What is left of that last step δ, after one δ₁, is the change of ψ′ since the place of its
    /// matrix, times δ. Second derivatives of the averages are at most |w|/3 and the derivatives
    /// lack at most 2.3·10⁻⁸|w|, each in two components: ‖z − ψ(z)‖₁ ≤ |w|(⅔(‖δ₁‖ + ½‖δ‖) +
    /// 5·10⁻⁸)‖δ‖. For
    /// |w| < 1 the map contracts, and there is no other solution.
    #[inline(always)]
    fn predict(&self, a: [f64; 3], dt: f64, dw: [f64; 1]) -> ([f64; 3], f64) {
        let weight = dt + self.noise * dw[0];
        let means = self.means(a, weight);
        let h = rotated([means[0].constant(), means[1].constant(), means[2].constant()]);
        let h =
            rotated([means[0].quadratic(h[0]), means[1].quadratic(h[1]), means[2].quadratic(h[2])]);
        let (values, slopes) = each(|i| means[i].cubic_with_slope(h[i]));
        let (h, _) = Reduced::new(slopes).step(h, values);
        let (values, slopes) = each(|i| means[i].estimate_with_slope(h[i]));
        let matrix = Reduced::new(slopes);
        let (h, first) = matrix.step(h, values);
        let (h, last) =
            matrix.step(h, [means[0].value(h[0]), means[1].value(h[1]), means[2].value(h[2])]);
        let bound = (weight.abs() * last) * ((first + 0.5 * last) * (2.0 / 3.0) + 5e-8);
        let bound = if weight.abs() < 1.0 { bound } else { f64::INFINITY };
        ([a[0] + h[0], a[1] + h[1], a[2] + h[2]], bound)
    }

    fn invariants(&self) -> Vec<Invariant> {
        let casimir = Invariant {
            name: "C",
            formula: "½(y₁ + y₂ + y₃)²",
            kind: InvariantKind::Casimir,
            form: Form::Quadratic,
            degree: 2.0,
        };
        vec![
            casimir,
            Invariant {
                name: "S",
                formula: "y₁ + y₂ + y₃",
                form: Form::Linear,
                degree: 1.0,
                ..casimir
            },
        ]
    }

    #[inline(always)]
    fn invariant<R: Real>(&self, index: usize, y: [R; 3]) -> R {
        let sum = y[0] + y[1] + y[2];
        match index {
            0 => sum * sum * 0.5,
            1 => sum,
            _ => no_invariant(self.name(), index),
        }
    }

    const IMPLICIT_STEP: ImplicitStep = ImplicitStep::Predicted;
}

/// B v.
#[inline(always)]
fn rotated<R: Real>(v: [R; 3]) -> [R; 3] {
    [v[1] - v[2], v[2] - v[0], v[0] - v[1]]
}

/// A pair for each component, as two vectors.
#[inline(always)]
fn each(pair: impl Fn(usize) -> (f64, f64)) -> ([f64; 3], [f64; 3]) {
    let (zero, one, two) = (pair(0), pair(1), pair(2));
    ([zero.0, one.0, two.0], [zero.1, one.1, two.1])
}

/// I − BS for a diagonal S on the plane of vectors with sum zero, in their first two components,
/// inverted.
#[derive(Clone, Copy)]
struct Reduced {
    inverse: [[f64; 2]; 2],
    determinant: f64,
}

impl Reduced {
    #[inline(always)]
    fn new(slopes: [f64; 3]) -> Self {
        let (upper, lower) = (slopes[1] + slopes[2], slopes[0] + slopes[2]);
        let (first, second) = (1.0 - slopes[2], 1.0 + slopes[2]);
        Self {
            inverse: [[second, upper], [-lower, first]],
            determinant: 1.0 / (first * second + upper * lower),
        }
    }

    /// h − (I − BS)⁻¹(h − B v) and the sum of the absolute values of its change.
    #[inline(always)]
    fn step(&self, h: [f64; 3], values: [f64; 3]) -> ([f64; 3], f64) {
        let residual = [h[0] - (values[1] - values[2]), h[1] - (values[2] - values[0])];
        let x = (self.inverse[0][0] * residual[0] + self.inverse[0][1] * residual[1])
            * self.determinant;
        let y = (self.inverse[1][0] * residual[0] + self.inverse[1][1] * residual[1])
            * self.determinant;
        let (first, second) = (h[0] - x, h[1] - y);
        ([first, second, -(first + second)], x.abs() + y.abs() + (x + y).abs())
    }
}
