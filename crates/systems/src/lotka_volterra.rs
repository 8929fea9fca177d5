//! The damped stochastic Lotka–Volterra system.

use dgrad::{GradientField, averaged, nodes_for_degree};
use real::Real;

use crate::{
    Form, ImplicitStep, Invariant, InvariantKind, PoissonSystem, SystemError, error::finite,
    system::no_invariant,
};

/// The Lotka–Volterra system of three positive populations (Bréhier, Cohen and Komori 2025,
/// Example 3): with positive integers p = ab and q = −b, H₀ = H₁ = H = y₁ᵖy₂^q y₃ and
/// B(y)v = c·y₁^{1−p}y₂^{1−q}·(av₂ + v₃, −av₁ − pv₃, −v₁ + pv₂).
///
/// The energy H has degree p + q + 1. The Casimir is linear: ab·y₁ + y₂ − a·y₃. (The logarithm
/// given as the Casimir in the paper is ln H.) H is a polynomial, and the discrete gradient is
/// exact to round-off.
///
/// `LotkaVolterra<2, 2>` is the case (a, b) = (−1, −2) of Bréhier, Cohen and Komori (2025), and
/// `LotkaVolterra<1, 1>` is the case (−1, −1).
#[derive(Clone, Copy, Debug)]
pub struct LotkaVolterra<const P: i32, const Q: i32> {
    c: f64,
}

/// The largest degree P + Q of ∇H for which there are nodes.
const MAX_DEGREE: i32 = 5;

impl<const P: i32, const Q: i32> LotkaVolterra<P, Q> {
    // ∇H has degree P + Q, and n nodes are exact up to degree 2n − 1.
    const NODES: usize = nodes_for_degree((P + Q) as usize);
    const P: f64 = P as f64;
    const Q: f64 = Q as f64;
    const A: f64 = -Self::P / Self::Q;

    /// The system with ab = P and −b = Q, hence a = −P/Q, and the scale c of B. It does not compile
    /// unless P ≥ 1, Q ≥ 1 and P + Q ≤ 5.
    ///
    /// # Errors
    /// [`SystemError`] unless c is finite.
    pub fn new(c: f64) -> Result<Self, SystemError> {
        const {
            assert!(
                P >= 1 && Q >= 1 && P + Q <= MAX_DEGREE,
                "exponents must be positive, with P + Q at most 5"
            )
        };
        Ok(Self { c: finite("the scale c", c)? })
    }

    /// y₁^{p−1}y₂^{q−1}, from which B and ∇H follow.
    #[inline(always)]
    fn powers<R: Real>(y: [R; 3]) -> R {
        y[0].powi(P - 1) * y[1].powi(Q - 1)
    }

    /// v with the factors p, q and 1, times `weight`.
    #[inline(always)]
    fn scaled<R: Real>(v: [R; 3], weight: f64) -> [R; 3] {
        [v[0] * (Self::P * weight), v[1] * (Self::Q * weight), v[2] * weight]
    }
}

/// The field (∂₁H/p, ∂₂H/q, ∂₃H), which is averaged without the constant factors p and q.
struct Gradient<const P: i32, const Q: i32>;

impl<const P: i32, const Q: i32> GradientField<3> for Gradient<P, Q> {
    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; 3]) -> [R; 3] {
        let powers = LotkaVolterra::<P, Q>::powers(y);
        let with_third = powers * y[2];
        [with_third * y[1], with_third * y[0], powers * (y[0] * y[1])]
    }
}

impl<const P: i32, const Q: i32> PoissonSystem<3, 1> for LotkaVolterra<P, Q> {
    fn name(&self) -> &'static str {
        "lotka-volterra"
    }

    fn parameters(&self) -> String {
        format!("a = {}, c = {}, p = {P}, q = {Q}", Self::A, self.c)
    }

    #[inline(always)]
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        let prefactor = Self::powers(y).recip() * self.c;
        [
            prefactor * (v[1] * Self::A + v[2]),
            -(prefactor * (v[0] * Self::A + v[2] * Self::P)),
            prefactor * (v[1] * Self::P - v[0]),
        ]
    }

    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> R {
        self.invariant(0, y) * (dt + dw[0])
    }

    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> [R; 3] {
        Self::scaled(Gradient::<P, Q>.gradient(y), dt + dw[0])
    }

    #[inline(always)]
    fn averaged_gradient<R: Real>(&self, a: [R; 3], b: [R; 3], dt: f64, dw: [f64; 1]) -> [R; 3] {
        let field = Gradient::<P, Q>;
        // The compiler decides the branch.
        let mean = match Self::NODES {
            2 => averaged::<2, R, _, 3>(&field, a, b),
            _ => averaged::<3, R, _, 3>(&field, a, b),
        };
        Self::scaled(mean, dt + dw[0])
    }

    fn invariants(&self) -> Vec<Invariant> {
        let energy = Invariant {
            name: "H",
            formula: "y₁^{ab} y₂^{−b} y₃",
            kind: InvariantKind::Energy,
            form: Form::Homogeneous,
            degree: Self::P + Self::Q + 1.0,
        };
        vec![energy, Invariant::linear_casimir("C", "ab y₁ + y₂ − a y₃")]
    }

    #[inline(always)]
    fn invariant<R: Real>(&self, index: usize, y: [R; 3]) -> R {
        match index {
            0 => Self::powers(y) * y[0] * y[1] * y[2],
            1 => y[0] * Self::P + y[1] - y[2] * Self::A,
            _ => no_invariant(self.name(), index),
        }
    }

    /// Checks that populations are positive. On the coordinate planes the prefactor of B or its
    /// derivative has a pole.
    fn check_domain(&self, y: [f64; 3]) -> Result<(), SystemError> {
        SystemError::unless_all(&y, |x| x > 0.0, "y1 > 0, y2 > 0 and y3 > 0")
    }

    const IMPLICIT_STEP: ImplicitStep = ImplicitStep::UnrolledFixedPoint;
}
