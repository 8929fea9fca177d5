//! Linear damping −γ(t)y: the rate γ(t) and its integral.

mod quadrature;

use std::ops::Deref;

use dgrad::Rule;
use real::Real;

use crate::{SystemError, error::finite};

pub use quadrature::{RateIntegrals, rate_integrals};

/// Linear damping −γ(t)y with the rate γ(t) and its integral.
///
/// The integrals over many small steps should add up to the integral over the whole interval up to
/// round-off. Use a closed form without cancellation if its arguments are exact. Otherwise use the
/// difference of an antiderivative at b and a: its errors cancel in the sum.
pub trait Damping: Send + Sync {
    /// γ(t), in 1/time.
    fn rate(&self, t: f64) -> f64;
    /// ∫ₐᵇ γ(s) ds, dimensionless.
    fn integral(&self, a: f64, b: f64) -> f64;
    /// The formula of γ for reports.
    fn describe(&self) -> String;
}

/// A damping that is lent or shared.
impl<G: Deref<Target: Damping> + Send + Sync> Damping for G {
    fn rate(&self, t: f64) -> f64 {
        (**self).rate(t)
    }
    fn integral(&self, a: f64, b: f64) -> f64 {
        (**self).integral(a, b)
    }
    fn describe(&self) -> String {
        (**self).describe()
    }
}

/// γ(t) = γ₀.
#[derive(Clone, Copy, Debug)]
pub struct Constant {
    rate: f64,
}

impl Constant {
    /// γ(t) = `rate` in 1/time. A negative rate excites the system.
    ///
    /// # Errors
    /// [`SystemError`] unless the rate is finite.
    pub fn new(rate: f64) -> Result<Self, SystemError> {
        Ok(Self { rate: finite("the damping rate", rate)? })
    }
}

impl Damping for Constant {
    fn rate(&self, _t: f64) -> f64 {
        self.rate
    }
    fn integral(&self, a: f64, b: f64) -> f64 {
        self.rate * (b - a)
    }
    fn describe(&self) -> String {
        format!("γ = {}", self.rate)
    }
}

/// γ(t) = αt.
#[derive(Clone, Copy, Debug)]
pub struct Linear {
    slope: f64,
}

impl Linear {
    /// γ(t) = `slope`·t, with the slope in 1/time².
    ///
    /// # Errors
    /// [`SystemError`] unless the slope is finite.
    pub fn new(slope: f64) -> Result<Self, SystemError> {
        Ok(Self { slope: finite("the slope of the damping rate", slope)? })
    }
}

impl Damping for Linear {
    fn rate(&self, t: f64) -> f64 {
        self.slope * t
    }
    fn integral(&self, a: f64, b: f64) -> f64 {
        0.5 * self.slope * (b - a) * (a + b)
    }
    fn describe(&self) -> String {
        format!("γ = {}t", factor(self.slope))
    }
}

/// γ(t) = α sin ωt.
pub type Sine = Harmonic<true>;

/// γ(t) = α cos ωt.
pub type Cosine = Harmonic<false>;

/// γ(t) = α sin ωt if `SINE`, otherwise γ(t) = α cos ωt.
#[derive(Clone, Copy, Debug)]
pub struct Harmonic<const SINE: bool> {
    amplitude: f64,
    frequency: f64,
}

impl<const SINE: bool> Harmonic<SINE> {
    /// α = `amplitude` and ω = `frequency`, both in 1/time.
    ///
    /// # Errors
    /// [`SystemError`] unless both are finite.
    pub fn new(amplitude: f64, frequency: f64) -> Result<Self, SystemError> {
        let amplitude = finite("the amplitude of the damping rate", amplitude)?;
        Ok(Self { amplitude, frequency: finite("the frequency of the damping rate", frequency)? })
    }

    /// ∫₀ᵗ γ = αt·sin(ωt/2)·sinc(ωt/2), or αt·sinc(ωt).
    fn primitive(self, t: f64) -> f64 {
        let phase = self.frequency * t;
        self.amplitude * t * if SINE { dgrad::mean_sine(0.0, phase) } else { Real::sinc(phase) }
    }
}

impl<const SINE: bool> Damping for Harmonic<SINE> {
    fn rate(&self, t: f64) -> f64 {
        let (sin, cos) = Real::sin_cos(self.frequency * t);
        self.amplitude * if SINE { sin } else { cos }
    }
    fn integral(&self, a: f64, b: f64) -> f64 {
        // The mean over [a, b] would have the argument ω(a+b)/2, which has a new rounding error of
        // up to an ulp of t in every step.
        self.primitive(b) - self.primitive(a)
    }
    fn describe(&self) -> String {
        let function = if SINE { "sin" } else { "cos" };
        format!("γ = {}{function} {}t", factor(self.amplitude), factor(self.frequency))
    }
}

/// A factor in a formula; the factor 1 is omitted.
fn factor(x: f64) -> String {
    if x == 1.0 { String::new() } else { format!("{x} ") }
}

/// Any γ(t) as a function, integrated by Gauss–Legendre quadrature.
#[derive(Clone, Debug)]
pub struct DampingFunction<F> {
    rate: F,
    rule: Rule,
}

impl<F: Fn(f64) -> f64 + Send + Sync> DampingFunction<F> {
    /// γ(t) = `rate`(t) in 1/time, with `nodes` Gauss–Legendre nodes per integral. Integrals are
    /// exact for polynomials of degree at most 2·nodes − 1. For a smooth γ the error is of order
    /// (b − a)^{2·nodes+1}.
    ///
    /// # Errors
    /// [`SystemError`] unless 1 ≤ nodes ≤ [`MAX_NODES`](dgrad::MAX_NODES).
    pub fn new(rate: F, nodes: usize) -> Result<Self, SystemError> {
        let rule = Rule::new(nodes).map_err(|error| SystemError(error.to_string()))?;
        Ok(Self { rate, rule })
    }
}

impl<F: Fn(f64) -> f64 + Send + Sync> Damping for DampingFunction<F> {
    fn rate(&self, t: f64) -> f64 {
        (self.rate)(t)
    }
    fn integral(&self, a: f64, b: f64) -> f64 {
        self.rule.integrate(a, b, &self.rate)
    }
    fn describe(&self) -> String {
        "γ given as a function".into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_integrals_agree_with_quadrature_and_add_up() {
        let closed: [&dyn Damping; 4] = [
            &Constant::new(2.0).unwrap(),
            &Linear::new(0.7).unwrap(),
            &Sine::new(1.0, 1.0).unwrap(),
            &Cosine::new(0.5, 2.0).unwrap(),
        ];
        for damping in closed {
            let by_nodes = DampingFunction::new(|t| damping.rate(t), 24).unwrap();
            for (a, b) in [(0.0, 1.0), (0.3, 2.9), (4.0, 4.0 + 1e-9), (10.0, 7.5), (1.0, 1.0)] {
                let (exact, numeric) = (damping.integral(a, b), by_nodes.integral(a, b));
                assert!(
                    (exact - numeric).abs() < 32.0 * f64::EPSILON * (1.0 + exact.abs()),
                    "{exact} {numeric}"
                );
            }
            // The integrals over 4096 short intervals add up to the integral over the whole.
            let steps = 4096;
            let sum: f64 = (0..steps)
                .map(|n| {
                    damping.integral(f64::from(n) * 10.0 / 4096.0, f64::from(n + 1) * 10.0 / 4096.0)
                })
                .sum();
            let whole = damping.integral(0.0, 10.0);
            assert!((sum - whole).abs() < 1e-12 * (1.0 + whole.abs()), "{sum} {whole}");
        }
    }
}
