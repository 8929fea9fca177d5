//! A damped stochastic Poisson system in three dimensions with constant B.

use dgrad::{ShortMean, mean_cosine};
use real::Real;

use crate::{
    Flows, ImplicitStep, Invariant, PoissonSystem, SystemError, error::finite, system::no_invariant,
};

/// A Poisson system with constant structure matrix (Bréhier, Cohen and Komori 2025, Example 5):
/// Bv = (v₂ − v₃, −v₁ + v₃, v₁ − v₂), H₀ = H = sin y₁ + sin y₂ + sin y₃ and H₁ = cH.
///
/// Casimirs: S = y₁ + y₂ + y₃, of degree 1, and C = ½S², of degree 2.
#[derive(Clone, Copy, Debug)]
pub struct Poisson3 {
    noise: f64,
}

impl Poisson3 {
    /// The system with noise of size c.
    ///
    /// # Errors
    /// [`SystemError`] unless c is finite.
    pub fn new(c: f64) -> Result<Self, SystemError> {
        Ok(Self { noise: finite("the noise size c", c)? })
    }
}

/// Parts sin yᵢ: y moves along Beᵢ, which has no component i.
impl Flows<3, 1> for Poisson3 {
    const PARTS: usize = 3;
    const EXACT: bool = true;

    #[inline(always)]
    fn flow<R: Real>(&self, part: usize, y: [R; 3], dt: R, dw: [R; 1]) -> [R; 3] {
        let shift = (dt + dw[0] * self.noise) * y[part].cos();
        match part {
            0 => [y[0], y[1] - shift, y[2] + shift],
            1 => [y[0] + shift, y[1], y[2] - shift],
            _ => [y[0] - shift, y[1] + shift, y[2]],
        }
    }
}

impl PoissonSystem<3, 1> for Poisson3 {
    fn name(&self) -> &'static str {
        "poisson3"
    }

    fn parameters(&self) -> String {
        format!("c = {}", self.noise)
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
        [
            mean_cosine(a[0], b[0]) * weight,
            mean_cosine(a[1], b[1]) * weight,
            mean_cosine(a[2], b[2]) * weight,
        ]
    }

    /// Newton's method for the changes h = b − a. Their sum is zero, so there are two unknowns. One
    /// step uses cubic polynomials for the averages. Then follow a step δ₁ with derivatives to
    /// seven digits and a simplified step δ with the same matrix.
    ///
    /// The residual after δ is δ times the change of ψ′ since the matrix was computed. The second
    /// derivatives of the averages are at most |w|/3, where w is the weight of H. The errors of the
    /// derivatives are at most 2.3·10⁻⁸|w|. Each enters two components, so
    /// ‖z − ψ(z)‖₁ ≤ |w|(⅔(‖δ₁‖ + ½‖δ‖) + 5·10⁻⁸)‖δ‖. For |w| < 1 the map contracts, so the
    /// solution is unique.
    #[inline(always)]
    fn predict(&self, a: [f64; 3], dt: f64, dw: [f64; 1]) -> ([f64; 3], f64) {
        let weight = dt + self.noise * dw[0];
        let means = [
            ShortMean::of_cosine(a[0], weight),
            ShortMean::of_cosine(a[1], weight),
            ShortMean::of_cosine(a[2], weight),
        ];
        let h = self.structure(a, [means[0].constant(), means[1].constant(), means[2].constant()]);
        let values = [means[0].quadratic(h[0]), means[1].quadratic(h[1]), means[2].quadratic(h[2])];
        let h = self.structure(a, values);
        let (values, slopes) = each(|i| means[i].cubic_with_slope(h[i]));
        let (h, _) = NewtonMatrix::new(slopes).step(h, values);
        let (values, slopes) = each(|i| means[i].estimate_with_slope(h[i]));
        let matrix = NewtonMatrix::new(slopes);
        let (h, first) = matrix.step(h, values);
        let (h, last) =
            matrix.step(h, [means[0].value(h[0]), means[1].value(h[1]), means[2].value(h[2])]);
        let bound = (weight.abs() * last) * ((first + 0.5 * last) * (2.0 / 3.0) + 5e-8);
        let bound = if weight.abs() < 1.0 { bound } else { f64::INFINITY };
        ([a[0] + h[0], a[1] + h[1], a[2] + h[2]], bound)
    }

    fn invariants(&self) -> Vec<Invariant> {
        vec![
            Invariant::quadratic_casimir("C", "½(y₁ + y₂ + y₃)²"),
            Invariant::linear_casimir("S", "y₁ + y₂ + y₃"),
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

/// Two vectors from a pair of numbers for each component.
#[inline(always)]
fn each(pair: impl Fn(usize) -> (f64, f64)) -> ([f64; 3], [f64; 3]) {
    let (zero, one, two) = (pair(0), pair(1), pair(2));
    ([zero.0, one.0, two.0], [zero.1, one.1, two.1])
}

/// The inverse of I − BS for a diagonal S, restricted to vectors with sum zero. It acts on their
/// first two components.
#[derive(Clone, Copy)]
struct NewtonMatrix {
    adjugate: [[f64; 2]; 2],
    inverse_determinant: f64,
}

impl NewtonMatrix {
    #[inline(always)]
    fn new(slopes: [f64; 3]) -> Self {
        let (upper, lower) = (slopes[1] + slopes[2], slopes[0] + slopes[2]);
        let (first, second) = (1.0 - slopes[2], 1.0 + slopes[2]);
        Self {
            adjugate: [[second, upper], [-lower, first]],
            inverse_determinant: 1.0 / (first * second + upper * lower),
        }
    }

    /// The Newton step h − (I − BS)⁻¹(h − Bv) for v = `values`, and the 1-norm of the change.
    #[inline(always)]
    fn step(&self, h: [f64; 3], values: [f64; 3]) -> ([f64; 3], f64) {
        let residual = [h[0] - (values[1] - values[2]), h[1] - (values[2] - values[0])];
        let [[a, b], [c, d]] = self.adjugate;
        let x = (a * residual[0] + b * residual[1]) * self.inverse_determinant;
        let y = (c * residual[0] + d * residual[1]) * self.inverse_determinant;
        let (first, second) = (h[0] - x, h[1] - y);
        ([first, second, -(first + second)], x.abs() + y.abs() + (x + y).abs())
    }
}
