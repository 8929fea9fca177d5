//! Random Hamiltonians: homogeneous polynomials, sines and exponentials.

use dgrad::GradientField;
use proptest::array::uniform;
use proptest::prelude::*;
use real::{Real, ScalarFunction, gradient};

use crate::rounding::dot;
use crate::structure::vector;

/// The largest degree, for whose gradient the two-node rule is exact.
pub const MAX_DEGREE: usize = 4;
/// Monomials of a polynomial.
const TERMS: usize = 3;

/// A homogeneous polynomial.
#[derive(Clone, Copy, Debug)]
pub struct Polynomial<const D: usize> {
    pub degree: usize,
    coefficients: [f64; TERMS],
    /// The variables that a monomial multiplies, the first `degree` of them.
    factors: [[usize; MAX_DEGREE]; TERMS],
}

impl<const D: usize> ScalarFunction<D> for Polynomial<D> {
    #[inline(never)]
    fn value<R: Real>(&self, y: [R; D]) -> R {
        let mut sum = R::zero();
        for t in 0..TERMS {
            let mut monomial = R::constant(self.coefficients[t]);
            for k in 0..self.degree {
                monomial = monomial * y[self.factors[t][k]];
            }
            sum = sum + monomial;
        }
        sum
    }
}

impl<const D: usize> GradientField<D> for Polynomial<D> {
    #[inline(never)]
    fn gradient<R: Real>(&self, y: [R; D]) -> [R; D] {
        gradient(self, y)
    }
}

impl<const D: usize> Polynomial<D> {
    /// cH.
    pub fn times(self, c: f64) -> Self {
        Self { coefficients: self.coefficients.map(|x| c * x), ..self }
    }
}

/// Any Hamiltonian.
#[derive(Clone, Copy, Debug)]
pub enum Hamiltonian<const D: usize> {
    /// A homogeneous polynomial.
    Polynomial(Polynomial<D>),
    /// a sin(wᵀy + φ).
    Sine(f64, [f64; D], f64),
    /// a exp(wᵀy).
    Exponential(f64, [f64; D]),
}

impl<const D: usize> Hamiltonian<D> {
    pub fn polynomial(&self) -> Polynomial<D> {
        match self {
            Self::Polynomial(polynomial) => *polynomial,
            other => panic!("no polynomial: {other:?}"),
        }
    }
}

impl<const D: usize> ScalarFunction<D> for Hamiltonian<D> {
    #[inline(never)]
    fn value<R: Real>(&self, y: [R; D]) -> R {
        match self {
            Self::Polynomial(polynomial) => polynomial.value(y),
            Self::Sine(a, w, phase) => {
                (dot(w.map(R::constant), y) + R::constant(*phase)).sin() * R::constant(*a)
            }
            Self::Exponential(a, w) => dot(w.map(R::constant), y).exp() * R::constant(*a),
        }
    }
}

/// A homogeneous polynomial of one of the degrees.
pub fn polynomial<const D: usize>(
    degrees: std::ops::RangeInclusive<usize>,
) -> impl Strategy<Value = Polynomial<D>> + Clone {
    (degrees, vector(1.0), uniform(uniform(0..D)))
        .prop_map(|(degree, coefficients, factors)| Polynomial { degree, coefficients, factors })
}

/// Any Hamiltonian.
pub fn hamiltonian<const D: usize>() -> impl Strategy<Value = Hamiltonian<D>> + Clone {
    prop_oneof![
        2 => polynomial(1..=MAX_DEGREE).prop_map(Hamiltonian::Polynomial),
        1 => (-1.0..1.0f64, vector(1.5), -3.0..3.0f64)
            .prop_map(|(a, w, phase)| Hamiltonian::Sine(a, w, phase)),
        1 => (-1.0..1.0f64, vector(0.7)).prop_map(|(a, w)| Hamiltonian::Exponential(a, w)),
    ]
}
