//! Random damping rates, and their integrals by a formula of this file's own.

use dgrad::Rule;
use proptest::prelude::*;
use systems::{Constant, Cosine, Damping, DampingFunction, Linear, Sine};

/// Nodes of every quadrature: over intervals of length 4 and frequencies up to 3 the error is below
/// 10⁻³⁰, and for exp(−t²) below 10⁻¹⁶.
const NODES: usize = 24;

/// A damping rate; pumping where it is negative.
#[derive(Clone, Copy, Debug)]
pub enum Rate {
    /// a.
    Constant(f64),
    /// at.
    Linear(f64),
    /// a sin ωt.
    Sine(f64, f64),
    /// a cos ωt.
    Cosine(f64, f64),
    /// a + b sin 3t + c exp(−t²), as a closure.
    Function(f64, f64, f64),
}

impl Rate {
    /// The damping as the library has it.
    pub fn damping(self) -> Box<dyn Damping> {
        match self {
            Self::Constant(a) => Box::new(Constant::new(a).unwrap()),
            Self::Linear(a) => Box::new(Linear::new(a).unwrap()),
            Self::Sine(a, frequency) => Box::new(Sine::new(a, frequency).unwrap()),
            Self::Cosine(a, frequency) => Box::new(Cosine::new(a, frequency).unwrap()),
            Self::Function(..) => {
                Box::new(DampingFunction::new(move |t| self.rate(t), NODES).unwrap())
            }
        }
    }

    /// γ(t), with the sines of the platform.
    fn rate(self, t: f64) -> f64 {
        match self {
            Self::Constant(a) => a,
            Self::Linear(a) => a * t,
            Self::Sine(a, frequency) => a * (frequency * t).sin(),
            Self::Cosine(a, frequency) => a * (frequency * t).cos(),
            Self::Function(a, b, c) => a + b * (3.0 * t).sin() + c * (-t * t).exp(),
        }
    }

    /// ∫γ from a to b, by quadrature whatever the rate is.
    pub fn integral(self, a: f64, b: f64) -> f64 {
        Rule::new(NODES).unwrap().integrate(a, b, |t| self.rate(t))
    }

    /// How far two computed integrals of γ from a to b may differ: a sum of 24 terms is rounded 24
    /// times, its terms and the closed forms a few times, and arguments like ωt are off by some
    /// ε·ωt.
    pub fn integral_error(self, a: f64, b: f64) -> f64 {
        let (rate, slope) = self.largest(b);
        f64::EPSILON * (b - a) * ((NODES + 8) as f64 * rate + 4.0 * slope * b)
    }

    /// How far the integral may be off because its end t is: a product or a sum that was rounded,
    /// twice at most.
    pub fn end_error(self, t: f64) -> f64 {
        f64::EPSILON * t * self.largest(t).0
    }

    /// Bounds for |γ| and |γ′| up to time t.
    fn largest(self, t: f64) -> (f64, f64) {
        match self {
            Self::Constant(a) => (a.abs(), 0.0),
            Self::Linear(a) => (a.abs() * t, a.abs()),
            Self::Sine(a, frequency) | Self::Cosine(a, frequency) => {
                (a.abs(), (a * frequency).abs())
            }
            Self::Function(a, b, c) => (a.abs() + b.abs() + c.abs(), 3.0 * b.abs() + c.abs()),
        }
    }
}

/// Dampings with coefficients of these sizes.
fn rates(
    linear: std::ops::Range<f64>,
    size: std::ops::Range<f64>,
    frequency: std::ops::Range<f64>,
) -> impl Strategy<Value = Rate> {
    prop_oneof![
        linear.prop_map(Rate::Linear),
        (size.clone(), frequency.clone()).prop_map(|(a, frequency)| Rate::Sine(a, frequency)),
        (size.clone(), frequency).prop_map(|(a, frequency)| Rate::Cosine(a, frequency)),
        (size.clone(), size.clone(), size).prop_map(|(a, b, c)| Rate::Function(a, b, c)),
    ]
}

/// Any damping.
pub fn any_rate() -> impl Strategy<Value = Rate> {
    let constant = (-2.0..2.0f64).prop_map(Rate::Constant);
    prop_oneof![1 => constant, 4 => rates(-0.2..0.2, -2.0..2.0, -3.0..3.0)]
}

/// Any damping that changes with time by an amount worth noticing.
pub fn changing_rate() -> impl Strategy<Value = Rate> {
    rates(0.1..0.2, 0.5..2.0, 0.5..3.0)
}
