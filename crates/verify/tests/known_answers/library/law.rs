//! Normal laws.

use std::f64::consts::{PI, TAU};

use statrs::distribution::ContinuousCDF;

/// P(N > x) for a standard normal N.
pub fn above(x: f64) -> f64 {
    statrs::distribution::Normal::standard().sf(x)
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
}
