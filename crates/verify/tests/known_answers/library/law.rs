//! Normal laws.

use std::f64::consts::{PI, TAU};

/// P(N > x) for a standard normal N. For |x| < 4 by the series Φ(x) = ½ + φ(x)·Σ x^{2k+1}/(2k+1)!!;
/// beyond, by the continued fraction of Mills' ratio, φ(x)/(x + 1/(x + 2/(x + …))).
pub fn above(x: f64) -> f64 {
    let density = (-0.5 * x * x).exp() / TAU.sqrt();
    if x.abs() < 4.0 {
        let (mut term, mut sum) = (x, x);
        for k in 1..80 {
            term *= x * x / f64::from(2 * k + 1);
            sum += term;
        }
        return 0.5 - density * sum;
    }
    let fraction = (1..60).rev().fold(x.abs(), |rest, k| x.abs() + f64::from(k) / rest);
    let tail = density / fraction;
    if x > 0.0 { tail } else { 1.0 - tail }
}

/// A normal law.
#[derive(Clone, Copy)]
pub struct Normal {
    pub mean: f64,
    pub deviation: f64,
}

impl Normal {
    pub fn new(mean: f64, variance: f64) -> Self {
        Self { mean, deviation: variance.sqrt() }
    }

    pub fn above(self, x: f64) -> f64 {
        above((x - self.mean) / self.deviation)
    }

    /// E cos kθ = e^{−k²s²/2} cos kμ.
    pub fn cos(self, k: f64) -> f64 {
        (-0.5 * (k * self.deviation).powi(2)).exp() * (k * self.mean).cos()
    }

    /// E sin kθ = e^{−k²s²/2} sin kμ.
    pub fn sin(self, k: f64) -> f64 {
        (-0.5 * (k * self.deviation).powi(2)).exp() * (k * self.mean).sin()
    }

    /// P(cos θ > x) = Σ_k P(|θ − 2πk| < arccos x).
    pub fn cos_above(self, x: f64) -> f64 {
        let reach = x.acos();
        let about = |k: f64| self.above(k - reach) - self.above(k + reach);
        (-20..=20).map(|k| about(TAU * f64::from(k))).sum()
    }

    /// P(sin θ > x) = P(cos(θ − π/2) > x).
    pub fn sin_above(self, x: f64) -> f64 {
        Self { mean: self.mean - 0.5 * PI, ..self }.cos_above(x)
    }

    /// E e^{kθ} = e^{kμ + k²s²/2}.
    pub fn exp(self, k: f64) -> f64 {
        (k * self.mean + 0.5 * (k * self.deviation).powi(2)).exp()
    }

    /// E f(θ) of an analytic f by the trapezoidal rule on ±12 standard deviations, which is exact
    /// to rounding.
    pub fn expect(self, f: impl Fn(f64) -> f64) -> f64 {
        const STEP: f64 = 1.0 / 64.0;
        let value = |k: i32| {
            let x = STEP * f64::from(k);
            (-0.5 * x * x).exp() / TAU.sqrt() * STEP * f(self.mean + self.deviation * x)
        };
        (-768..=768).map(value).sum()
    }
}
