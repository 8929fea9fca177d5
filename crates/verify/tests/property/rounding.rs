//! A number that carries a bound of its own rounding error.
//!
//! Running error analysis (Higham, *Accuracy and Stability of Numerical Algorithms*, 2002, §3.3):
//! every operation adds half an ulp of its result to the propagated errors of its operands.
//! Evaluating a formula with such numbers gives the bits of the `f64` evaluation and the tolerance
//! that it deserves, however the terms cancel. Products of bounds with ε that a rigorous bound
//! would add are a relative 10⁻¹⁵ of it and left out.

use std::ops::{Add, Div, Mul, Neg, Sub};

use real::{Real, elementary};

/// Half an ulp, relative: the rounding of one operation.
pub const UNIT: f64 = 0.5 * f64::EPSILON;

/// What the elementary functions may be off by, relative: 1.1 ulp is asserted for sine, cosine and
/// exponential, 2 for the cardinal sine.
const ELEMENTARY: f64 = 2.0 * f64::EPSILON;

/// Constants on the right of an operator are nodes, weights and ½: the two-node rule is good to
/// 1.8ε, relative.
const CONSTANT: f64 = 2.0 * f64::EPSILON;

/// A computed value and a bound for its distance to the exact one.
#[derive(Clone, Copy, Debug)]
pub struct Bounded {
    pub value: f64,
    pub error: f64,
}

impl Bounded {
    /// A number without error.
    pub fn exact(value: f64) -> Self {
        Self { value, error: 0.0 }
    }

    /// A number that has been rounded once.
    pub fn rounded(value: f64) -> Self {
        Self::new(value, 0.0)
    }

    fn new(value: f64, propagated: f64) -> Self {
        Self { value, error: propagated + UNIT * value.abs() }
    }

    /// Largest size of the exact value.
    pub fn size(self) -> f64 {
        self.value.abs() + self.error
    }

    fn of_constant(value: f64) -> Self {
        Self { value, error: CONSTANT * value.abs() }
    }
}

impl Add for Bounded {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self::new(self.value + b.value, self.error + b.error)
    }
}
impl Sub for Bounded {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        Self::new(self.value - b.value, self.error + b.error)
    }
}
impl Mul for Bounded {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        Self::new(self.value * b.value, self.value.abs() * b.error + self.error * b.size())
    }
}
impl Div for Bounded {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let quotient = self.value / b.value;
        Self::new(quotient, (self.error + quotient.abs() * b.error) / (b.value.abs() - b.error))
    }
}
impl Neg for Bounded {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, ..self }
    }
}
impl Add<f64> for Bounded {
    type Output = Self;
    fn add(self, b: f64) -> Self {
        self + Self::of_constant(b)
    }
}
impl Sub<f64> for Bounded {
    type Output = Self;
    fn sub(self, b: f64) -> Self {
        self - Self::of_constant(b)
    }
}
impl Mul<f64> for Bounded {
    type Output = Self;
    fn mul(self, b: f64) -> Self {
        self * Self::of_constant(b)
    }
}
impl Div<f64> for Bounded {
    type Output = Self;
    fn div(self, b: f64) -> Self {
        self / Self::of_constant(b)
    }
}

impl Real for Bounded {
    fn constant(x: f64) -> Self {
        Self::exact(x)
    }
    fn value(self) -> f64 {
        self.value
    }
    fn sin_cos(self) -> (Self, Self) {
        // Both have slopes of at most 1.
        let (sine, cosine) = elementary::sin_cos(self.value);
        let bounded = |value: f64| Self { value, error: self.error + ELEMENTARY * value.abs() };
        (bounded(sine), bounded(cosine))
    }
    fn exp(self) -> Self {
        let value = elementary::exp(self.value);
        Self { value, error: value * (self.error.exp_m1() + ELEMENTARY) }
    }
    fn ln(self) -> Self {
        let value = elementary::ln(self.value);
        Self { value, error: self.error / (self.value - self.error) + ELEMENTARY * value.abs() }
    }
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        Self::new(value, self.error / value)
    }
    fn sinc(self) -> Self {
        // The slope is at most 0.44.
        let value = elementary::sinc(self.value);
        Self { value, error: 0.5 * self.error + ELEMENTARY * value.abs() }
    }
    fn select(condition: bool, a: Self, b: Self) -> Self {
        if condition { a } else { b }
    }
}

/// aᵀb.
pub fn dot<R: Real, const D: usize>(a: [R; D], b: [R; D]) -> R {
    let mut sum = a[0] * b[0];
    for i in 1..D {
        sum = sum + a[i] * b[i];
    }
    sum
}

/// The bound is a bound: 1 is added to x and subtracted again, which leaves anything up to half an
/// ulp of 1.
#[test]
fn cancellation_is_noticed() {
    let mut largest: f64 = 0.0;
    for k in 1..1000 {
        let x = 1e-3 / f64::from(k);
        let again = (Bounded::exact(x) + Bounded::exact(1.0)) - Bounded::exact(1.0);
        assert!((again.value - x).abs() <= again.error);
        largest = largest.max((again.value - x).abs() / again.error);
    }
    assert!(largest > 0.9, "{largest}");
}
