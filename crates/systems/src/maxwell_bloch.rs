//! The damped stochastic Maxwell–Bloch system.

use real::Real;

use crate::{
    Flows, ImplicitStep, Invariant, PoissonSystem,
    cayley::{turned, turned_about},
    system::no_invariant,
};

/// The Maxwell–Bloch system of laser-matter dynamics (Bréhier, Cohen and Komori 2025, Example 4):
/// B(y)v = (−y₃v₂ + y₂v₃, y₃v₁, −y₂v₁), H₀ = ½y₁² + y₃, H₁ = y₃.
///
/// Casimir: ½(y₂² + y₃²), of degree 2.
#[derive(Clone, Copy, Debug, Default)]
pub struct MaxwellBloch;

/// Parts: ½y₁², a rotation of (y₂, y₃) by Cayley's map, then y₃, a shift of y₁ by y₂.
impl Flows<3, 1> for MaxwellBloch {
    const PARTS: usize = 2;

    const NOISE_PARTS: [Option<usize>; 1] = [Some(1)];

    #[inline(always)]
    fn flow<R: Real>(&self, part: usize, y: [R; 3], dt: R, dw: [R; 1]) -> [R; 3] {
        match part {
            0 => turned_about(0, y, dt, false),
            _ => [y[0] + (dt + dw[0]) * y[1], y[1], y[2]],
        }
    }

    #[inline(always)]
    fn precise_flow<R: Real>(&self, part: usize, y: [R; 3], dt: R, dw: [R; 1]) -> [R; 3] {
        match part {
            0 => turned_about(0, y, dt, true),
            _ => self.flow(part, y, dt, dw),
        }
    }
}

impl PoissonSystem<3, 1> for MaxwellBloch {
    fn name(&self) -> &'static str {
        "maxwell-bloch"
    }

    #[inline(always)]
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        [y[1] * v[2] - y[2] * v[1], y[2] * v[0], -(y[1] * v[0])]
    }

    /// A rotation of (y₂, y₃) by Cayley's map, then y₁.
    #[inline(always)]
    fn cayley<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        let (second, third) = turned(y[1], y[2], v[0] * 0.5);
        let first = y[0] + ((y[1] + second) * v[2] - (y[2] + third) * v[1]) * 0.5;
        [first, second, third]
    }

    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> R {
        y[0] * y[0] * (0.5 * dt) + y[2] * (dt + dw[0])
    }

    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> [R; 3] {
        [y[0] * dt, R::zero(), R::constant(dt + dw[0])]
    }

    fn invariants(&self) -> Vec<Invariant> {
        vec![Invariant::quadratic_casimir("C", "½(y₂² + y₃²)")]
    }

    #[inline(always)]
    fn invariant<R: Real>(&self, index: usize, y: [R; 3]) -> R {
        match index {
            0 => (y[1] * y[1] + y[2] * y[2]) * 0.5,
            _ => no_invariant(self.name(), index),
        }
    }

    const IMPLICIT_STEP: ImplicitStep = ImplicitStep::UnrolledFixedPoint;
}
