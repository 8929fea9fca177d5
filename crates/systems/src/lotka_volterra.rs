//! The damped stochastic Lotka–Volterra system.

use dgrad::{GradientField, averaged, nodes_for_degree};
use real::Real;

use crate::{
    Form, ImplicitStep, Invariant, InvariantKind, PoissonSystem, SystemError, error::finite,
    system::no_invariant,
};

/// The Lotka–Volterra system of three positive populations (Bréhier, Cohen and Komori 2025,
/// Example 3): with p = ab and q = −b, H₀ = H₁ = H = y₁ᵖy₂^q y₃ and
/// B(y)v = c·y₁^{1−p}y₂^{1−q}·(av₂ + v₃, −av₁ − pv₃, −v₁ + pv₂).
///
/// The energy H has degree p + q + 1. The Casimir is linear: ab·y₁ + y₂ − a·y₃. (The logarithm
/// given as the Casimir in the paper is ln H.) The type E computes the powers, see
/// [`IntegerExponents`] and [`RealExponents`].
#[derive(Clone, Copy, Debug)]
pub struct LotkaVolterra<E> {
    a: f64,
    c: f64,
    exponents: E,
}

/// The exponents p = ab of y₁ and q = −b of y₂ in H = y₁ᵖy₂^q y₃.
pub trait Exponents: Copy + Send + Sync {
    /// Gauss–Legendre nodes of ∇̄: 2, 3, 4, 5, or 12 for any other number.
    const NODES: usize;
    /// p = ab.
    fn p(&self) -> f64;
    /// q = −b.
    fn q(&self) -> f64;
    /// y₁^{p−1}y₂^{q−1}, from which B and ∇H follow.
    fn powers<R: Real>(&self, y1: R, y2: R) -> R;
}

/// Positive integer exponents p = P and q = Q with P + Q ≤ 9: H is a polynomial and the discrete
/// gradient is exact to round-off.
///
/// `IntegerExponents<2, 2>` is the case (a, b) = (−1, −2) of Bréhier, Cohen and Komori (2025), and
/// `IntegerExponents<1, 1>` is the case (−1, −1).
#[derive(Clone, Copy, Debug)]
pub struct IntegerExponents<const P: i32, const Q: i32>;

/// The largest degree P + Q of ∇H for which the nodes of [`IntegerExponents`] are exact.
const MAX_DEGREE: i32 = 9;

impl<const P: i32, const Q: i32> Exponents for IntegerExponents<P, Q> {
    // ∇H has degree P + Q, and n nodes are exact up to degree 2n − 1.
    const NODES: usize = nodes_for_degree((P + Q) as usize);

    fn p(&self) -> f64 {
        f64::from(P)
    }
    fn q(&self) -> f64 {
        f64::from(Q)
    }
    #[inline(always)]
    fn powers<R: Real>(&self, y1: R, y2: R) -> R {
        y1.powi(P - 1) * y2.powi(Q - 1)
    }
}

/// Any real exponents. Powers are e^{p ln y}, and the discrete gradient is a quadrature with 12
/// nodes. Its error over one step is below round-off while y stays away from the coordinate planes.
#[derive(Clone, Copy, Debug)]
pub struct RealExponents {
    p: f64,
    q: f64,
}

const REAL_EXPONENT_NODES: usize = 12;

impl Exponents for RealExponents {
    const NODES: usize = REAL_EXPONENT_NODES;

    fn p(&self) -> f64 {
        self.p
    }
    fn q(&self) -> f64 {
        self.q
    }
    #[inline(always)]
    fn powers<R: Real>(&self, y1: R, y2: R) -> R {
        (y1.ln() * (self.p - 1.0) + y2.ln() * (self.q - 1.0)).exp()
    }
}

impl<const P: i32, const Q: i32> LotkaVolterra<IntegerExponents<P, Q>> {
    /// The system with ab = P and −b = Q, hence a = −P/Q, and the scale c of B. It does not compile
    /// unless P ≥ 1, Q ≥ 1 and P + Q ≤ 9.
    ///
    /// # Errors
    /// [`SystemError::Parameter`] unless c is finite.
    pub fn integer(c: f64) -> Result<Self, SystemError> {
        const {
            assert!(
                P >= 1 && Q >= 1 && P + Q <= MAX_DEGREE,
                "exponents must be positive, with P + Q at most 9"
            )
        };
        let a = -f64::from(P) / f64::from(Q);
        Ok(Self { a, c: finite("the scale c", c)?, exponents: IntegerExponents })
    }
}

impl LotkaVolterra<RealExponents> {
    /// The system with parameters a and b, and the scale c of B.
    ///
    /// # Errors
    /// [`SystemError::Parameter`] unless all three are finite.
    pub fn new(a: f64, b: f64, c: f64) -> Result<Self, SystemError> {
        let (a, b) = (finite("a", a)?, finite("b", b)?);
        Ok(Self { a, c: finite("the scale c", c)?, exponents: RealExponents { p: a * b, q: -b } })
    }
}

/// The field (∂₁H/p, ∂₂H/q, ∂₃H), which is averaged without the constant factors p and q.
struct Gradient<E>(E);

impl<E: Exponents> GradientField<3> for Gradient<E> {
    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; 3]) -> [R; 3] {
        let powers = self.0.powers(y[0], y[1]);
        let with_third = powers * y[2];
        [with_third * y[1], with_third * y[0], powers * (y[0] * y[1])]
    }
}

impl<E: Exponents> LotkaVolterra<E> {
    /// v with the factors p, q and 1, times `weight`.
    #[inline(always)]
    fn scaled<R: Real>(&self, v: [R; 3], weight: f64) -> [R; 3] {
        [v[0] * (self.exponents.p() * weight), v[1] * (self.exponents.q() * weight), v[2] * weight]
    }
}

impl<E: Exponents> PoissonSystem<3, 1> for LotkaVolterra<E> {
    fn name(&self) -> &'static str {
        "lotka-volterra"
    }

    fn parameters(&self) -> String {
        let (p, q) = (self.exponents.p(), self.exponents.q());
        format!("a = {}, c = {}, p = {p}, q = {q}", self.a, self.c)
    }

    #[inline(always)]
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        let prefactor = self.exponents.powers(y[0], y[1]).recip() * self.c;
        let p = self.exponents.p();
        [
            prefactor * (v[1] * self.a + v[2]),
            -(prefactor * (v[0] * self.a + v[2] * p)),
            prefactor * (v[1] * p - v[0]),
        ]
    }

    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> R {
        self.invariant(0, y) * (dt + dw[0])
    }

    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> [R; 3] {
        self.scaled(Gradient(self.exponents).gradient(y), dt + dw[0])
    }

    #[inline(always)]
    fn averaged_gradient<R: Real>(&self, a: [R; 3], b: [R; 3], dt: f64, dw: [f64; 1]) -> [R; 3] {
        let field = Gradient(self.exponents);
        // The compiler decides the branch.
        let mean = match E::NODES {
            2 => averaged::<2, R, _, 3>(&field, a, b),
            3 => averaged::<3, R, _, 3>(&field, a, b),
            4 => averaged::<4, R, _, 3>(&field, a, b),
            5 => averaged::<5, R, _, 3>(&field, a, b),
            _ => averaged::<REAL_EXPONENT_NODES, R, _, 3>(&field, a, b),
        };
        self.scaled(mean, dt + dw[0])
    }

    fn invariants(&self) -> Vec<Invariant> {
        let energy = Invariant {
            name: "H",
            formula: "y₁^{ab} y₂^{−b} y₃",
            kind: InvariantKind::Energy,
            form: Form::Homogeneous,
            degree: self.exponents.p() + self.exponents.q() + 1.0,
        };
        vec![energy, Invariant::linear_casimir("C", "ab y₁ + y₂ − a y₃")]
    }

    #[inline(always)]
    fn invariant<R: Real>(&self, index: usize, y: [R; 3]) -> R {
        match index {
            0 => self.exponents.powers(y[0], y[1]) * y[0] * y[1] * y[2],
            1 => y[0] * self.exponents.p() + y[1] - y[2] * self.a,
            _ => no_invariant(self.name(), index),
        }
    }

    /// Populations are positive. On the coordinate planes the prefactor of B or its derivative has
    /// a pole.
    fn check_domain(&self, y: [f64; 3]) -> Result<(), SystemError> {
        match y.iter().position(|&component| component.is_nan() || component <= 0.0) {
            None => Ok(()),
            Some(i) => Err(SystemError::OutsideDomain {
                component: i + 1,
                value: y[i],
                domain: "y1 > 0, y2 > 0 and y3 > 0",
            }),
        }
    }

    const IMPLICIT_STEP: ImplicitStep =
        if E::NODES <= 3 { ImplicitStep::UnrolledFixedPoint } else { ImplicitStep::FixedPoint };
}
