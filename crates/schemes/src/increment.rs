//! The operations that the formula of a scheme may use.

use std::{
    marker::PhantomData,
    ops::{Add, Mul, Sub},
};

use noise::Noise;
use real::Real;
use systems::{PoissonSystem, area_gradient, is_quadratic, ito_correction};

use crate::Step;

/// One step on one path: the Hamiltonian increment h = H₀τ + Σ HₘΔWₘ, the structure matrix B, and
/// linear combinations of states.
///
/// The formula of a scheme uses only these operations. So the same formula works on `f64`, on dual
/// numbers for Newton's method, and in any dimension.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not the increment of a step",
    note = "formulas are generic over `I: Increment`; the crate makes increments of systems"
)]
pub trait Increment: Copy {
    /// A state or a direction, with sums, differences and multiples by numbers.
    type Vector: Copy
        + Add<Output = Self::Vector>
        + Sub<Output = Self::Vector>
        + Mul<f64, Output = Self::Vector>;

    /// Time, step size and damping of the step.
    fn step(&self) -> &Step;

    /// Whether h is a polynomial of degree at most two, so that ∇̄h(a, b) = ∇h((a+b)/2).
    fn is_quadratic(self) -> bool;

    /// B(y)·v.
    fn structure(self, y: Self::Vector, v: Self::Vector) -> Self::Vector;

    /// ∇h(y).
    fn gradient(self, y: Self::Vector) -> Self::Vector;

    /// ∇̄h(a, b) = ∫₀¹ ∇h((1−η)a + ηb) dη, the averaged discrete gradient.
    fn averaged_gradient(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;

    /// The solution of z = y + B((y+z)/2)·v, for B that is affine in y.
    fn cayley(self, y: Self::Vector, v: Self::Vector) -> Self::Vector;

    /// ½Σ fₘ′(y)fₘ(y) with fₘ = B∇Hₘ: the drift of the Itô form minus that of the Stratonovich
    /// form, per unit of time.
    fn ito_correction(self, y: Self::Vector) -> Self::Vector;

    /// Σ_{m<l} A_ml \[fₘ, f_l\](y) with the Lévy areas A of the step and [f, g] = g′f − f′g. Zero
    /// unless the scheme declares `READS_AREAS`.
    fn commutators(self, y: Self::Vector) -> Self::Vector;

    /// Σ_{m<l} A_ml ∇{Hₘ, H_l}(y), where Jacobi's identity holds the vector v with
    /// [`commutators`](Self::commutators) = −B(y)v.
    fn area_gradient(self, y: Self::Vector) -> Self::Vector;

    /// B(y)∇h(y), the vector field over the step.
    #[inline(always)]
    fn field(self, y: Self::Vector) -> Self::Vector {
        self.structure(y, self.gradient(y))
    }

    /// B((a+b)/2)·∇̄h(a, b), the change over an energy-preserving step from a to b (Cohen and
    /// Hairer 2011).
    #[inline(always)]
    fn averaged_field(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        self.structure((a + b) * 0.5, self.averaged_gradient(a, b))
    }
}

/// A vector of D numbers of type R with addition, subtraction and multiplication by a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector<R, const D: usize>(pub [R; D]);

impl<R: Real, const D: usize> Add for Vector<R, D> {
    type Output = Self;
    #[inline(always)]
    fn add(mut self, other: Self) -> Self {
        for i in 0..D {
            self.0[i] = self.0[i] + other.0[i];
        }
        self
    }
}

impl<R: Real, const D: usize> Sub for Vector<R, D> {
    type Output = Self;
    #[inline(always)]
    fn sub(mut self, other: Self) -> Self {
        for i in 0..D {
            self.0[i] = self.0[i] - other.0[i];
        }
        self
    }
}

impl<R: Real, const D: usize> Mul<f64> for Vector<R, D> {
    type Output = Self;
    #[inline(always)]
    fn mul(mut self, factor: f64) -> Self {
        for i in 0..D {
            self.0[i] = self.0[i] * factor;
        }
        self
    }
}

/// The increment of a [`PoissonSystem`] on numbers of type R; S is a reference to the system.
#[derive(Clone, Copy)]
pub struct SystemIncrement<S, R, const D: usize, const M: usize> {
    pub system: S,
    pub step: Step,
    pub noise: Noise<M>,
    pub number: PhantomData<R>,
}

impl<S: PoissonSystem<D, M>, R: Real, const D: usize, const M: usize> Increment
    for SystemIncrement<&S, R, D, M>
{
    type Vector = Vector<R, D>;

    #[inline(always)]
    fn step(&self) -> &Step {
        &self.step
    }
    #[inline(always)]
    fn is_quadratic(self) -> bool {
        is_quadratic(self.system, self.step.tau, self.noise.increments)
    }
    #[inline(always)]
    fn structure(self, y: Vector<R, D>, v: Vector<R, D>) -> Vector<R, D> {
        Vector(self.system.structure(y.0, v.0))
    }
    #[inline(always)]
    fn gradient(self, y: Vector<R, D>) -> Vector<R, D> {
        Vector(self.system.gradient(y.0, self.step.tau, self.noise.increments))
    }
    #[inline(always)]
    fn averaged_gradient(self, a: Vector<R, D>, b: Vector<R, D>) -> Vector<R, D> {
        Vector(self.system.averaged_gradient(a.0, b.0, self.step.tau, self.noise.increments))
    }
    #[inline(always)]
    fn cayley(self, y: Vector<R, D>, v: Vector<R, D>) -> Vector<R, D> {
        Vector(self.system.cayley(y.0, v.0))
    }
    #[inline(always)]
    fn ito_correction(self, y: Vector<R, D>) -> Vector<R, D> {
        Vector(ito_correction(self.system, y.0))
    }
    #[inline(always)]
    fn commutators(self, y: Vector<R, D>) -> Vector<R, D> {
        Vector(self.system.commutators(y.0, self.noise.areas))
    }
    #[inline(always)]
    fn area_gradient(self, y: Vector<R, D>) -> Vector<R, D> {
        Vector(area_gradient(self.system, y.0, self.noise.areas))
    }
    #[inline(always)]
    fn averaged_field(self, a: Vector<R, D>, b: Vector<R, D>) -> Vector<R, D> {
        Vector(self.system.averaged_field(a.0, b.0, self.step.tau, self.noise.increments))
    }
}

/// A constant vector on numbers of type R.
#[inline(always)]
pub fn constant<R: Real, const D: usize>(y: [f64; D]) -> Vector<R, D> {
    let mut constant = [R::zero(); D];
    for i in 0..D {
        constant[i] = R::constant(y[i]);
    }
    Vector(constant)
}
