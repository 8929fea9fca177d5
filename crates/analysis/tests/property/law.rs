//! The conformal law F(y₁) = e^{−p∫γ}F(y₀) of one step, and what round-off and the solver may make
//! of it.
//!
//! Let ẑ = e^{−∫γ}y₀ and z = e^{∫γ}y₁ be the two sides of the implicit equation z = ψ(z), with
//! residual r = z − ψ(z). F(z) − F(ẑ) = sᵀ(z − ẑ), where s is ∇F at the middle (linear and
//! quadratic F) or ∇̄F, and sᵀ(ψ(z) − ẑ) = 0 by the structure of the system. Hence F(z) − F(ẑ) =
//! sᵀr exactly, and what is left is a bound for r:
//!
//! |r|₁ ≤ ε(|z|₁ + |ẑ|₁)(S + 2‖I − ψ′‖₁) + rounding of ψ.
//!
//! S is what the solver leaves on purpose; the norm counts the rounding of z (half an ε when it is
//! formed, half when it is damped) and Newton's last change; the rounding of ψ is bounded by
//! evaluating it with [`Bounded`] numbers.

use dgrad::{averaged, midpoint};
use nonlin::Method;
use real::{Real, ScalarFunction, Varies, derivatives, seeded};
use schemes::Step;
use systems::PoissonSystem;

use crate::damping::Rate;
use crate::hamiltonian::Polynomial;
use crate::rounding::{Bounded, UNIT, dot, rounded, size};
use crate::structure::Casimir;

/// S for Newton: changes up to 2ε are accepted by its robust variant, squares of 2⁻³² by the fast
/// one.
const NEWTON: f64 = 4.0;
/// S for the fixed point: it means to stop at 2ε, but foresees the residual from two changes, and
/// where modes that contract differently mix it may leave up to this (see the tests of `nonlin`).
const FIXED_POINT: f64 = 256.0;

/// S.
pub fn solver_leaves(method: Method) -> f64 {
    match method {
        Method::Newton => NEWTON,
        Method::FixedPoint => FIXED_POINT,
    }
}

/// A homogeneous function that should obey the law.
pub trait Conserved<const D: usize> {
    /// Its degree p.
    fn degree(&self) -> i32;
    /// F(y).
    fn value<R: Real>(&self, y: [R; D]) -> R;
    /// s with sᵀ(b − a) = F(b) − F(a).
    fn slope<R: Real>(&self, a: [R; D], b: [R; D]) -> [R; D];
}

impl<const D: usize> Conserved<D> for Casimir<D> {
    fn degree(&self) -> i32 {
        match self {
            Self::Linear(_) => 1,
            Self::Quadratic(_) => 2,
        }
    }
    fn value<R: Real>(&self, y: [R; D]) -> R {
        dot(self.normal(y), y) / R::constant(f64::from(self.degree()))
    }
    fn slope<R: Real>(&self, a: [R; D], b: [R; D]) -> [R; D] {
        self.normal(midpoint(a, b))
    }
}

impl<const D: usize> Conserved<D> for Polynomial<D> {
    fn degree(&self) -> i32 {
        self.degree as i32
    }
    fn value<R: Real>(&self, y: [R; D]) -> R {
        ScalarFunction::value(self, y)
    }
    fn slope<R: Real>(&self, a: [R; D], b: [R; D]) -> [R; D] {
        averaged::<2, R, _, D>(self, a, b)
    }
}

/// A map of ℝᴰ, generic over the number.
pub trait Map<const D: usize> {
    fn value<R: Real>(&self, z: [R; D]) -> [R; D];
}

/// ψ of `sexp`, written once more: ẑ + B((ẑ+z)/2)∇̄h(ẑ, z).
pub struct SexpMap<'a, S, const D: usize, const M: usize> {
    pub system: &'a S,
    pub tau: f64,
    pub dw: [f64; M],
    pub before: [f64; D],
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Map<D> for SexpMap<'_, S, D, M> {
    fn value<R: Real>(&self, z: [R; D]) -> [R; D] {
        let before = self.before.map(R::constant);
        let slope = self.system.averaged_gradient(before, z, self.tau, self.dw);
        let change = self.system.structure(midpoint(before, z), slope);
        std::array::from_fn(|i| before[i] + change[i])
    }
}

pub fn norm<const D: usize>(x: [f64; D]) -> f64 {
    x.iter().map(|component| component.abs()).sum()
}

/// ψ′(z), column by column.
pub fn columns<P: Map<D>, const D: usize>(map: &P, z: [f64; D]) -> [[f64; D]; D] {
    std::array::from_fn(|j| derivatives(map.value(seeded::<f64, Varies, D>(z, j))))
}

/// |z − ψ(z)|₁, and the bound for it that is derived above.
pub fn residual<P: Map<D>, const D: usize>(
    map: &P,
    before: [f64; D],
    z: [f64; D],
    solver: f64,
) -> (f64, f64) {
    let value = map.value(z);
    let rounding: f64 = map.value(z.map(Bounded::exact)).iter().map(|x| x.error).sum();
    let mut jacobian = columns(map, z).map(|column| column.map(|x| -x));
    for j in 0..D {
        jacobian[j][j] += 1.0;
    }
    let largest = jacobian.map(norm).into_iter().fold(0.0, f64::max);
    let defect = norm::<D>(std::array::from_fn(|i| z[i] - value[i]));
    (defect, f64::EPSILON * (norm(z) + norm(before)) * (solver + 2.0 * largest) + rounding)
}

/// One step from y₀ to y₁.
pub struct Transition<const D: usize> {
    pub step: Step,
    pub y0: [f64; D],
    pub y1: [f64; D],
}

/// What became of a step.
pub struct Verdict {
    /// |F(y₁) − e^{−p∫γ}F(y₀)|.
    pub defect: f64,
    /// The bound for it.
    pub allowed: f64,
    /// e^{−p∫γ}.
    pub law: f64,
    /// Whether the residual is as small as a solver leaves it.
    pub solved: bool,
}

impl<const D: usize> Transition<D> {
    /// ẑ, the same bits as in `sexp`.
    pub fn before(&self) -> [f64; D] {
        self.y0.map(|x| self.step.first_decay * x)
    }

    /// z up to a rounding.
    pub fn after(&self) -> [f64; D] {
        self.y1.map(|x| x / self.step.second_decay)
    }

    /// The law of F over the step by an integral that `step` had no part in.
    pub fn judge<F: Conserved<D>, P: Map<D>>(
        &self,
        function: &F,
        map: &P,
        rate: Rate,
        solver: f64,
    ) -> Verdict {
        let degree = f64::from(function.degree());
        let (start, end) = (self.step.t, self.step.t + self.step.tau);
        let exponent = degree * rate.integral(start, end);
        let law = (-exponent).exp();
        let value = |y: [f64; D]| function.value(y.map(Bounded::exact)).value;
        let (f0, f1) = (value(self.y0), value(self.y1));

        let (before, after) = (self.before(), self.after());
        let (residual, allowed_residual) = residual(map, before, after, solver);
        let rounding: f64 = map.value(after.map(Bounded::exact)).iter().map(|x| x.error).sum();
        let slope = function.slope(before.map(Bounded::exact), after.map(Bounded::exact));
        let steepest = slope.into_iter().map(size).fold(0.0, f64::max);
        // ẑ and y₁ are products that were rounded.
        let noise = |y: [f64; D]| function.value(y.map(rounded)).error;
        let second = self.step.second_decay.powi(function.degree());
        let mut allowed =
            noise(self.y1) + second * (noise(before) + steepest * (allowed_residual + rounding));
        allowed += law * noise(self.y0);
        // Each decay is an exponential, good to 1.1 ulp, and counts p times; t + τ may round away
        // from (n + 1)τ.
        let time = rate.integral_error(start, end) + rate.end_error(end);
        allowed += (law * f0).abs()
            * (degree * time + (3.0 * degree + 3.0 + exponent.abs()) * f64::EPSILON);
        allowed += 2.0 * UNIT * f1.abs();
        Verdict {
            defect: (f1 - law * f0).abs(),
            allowed,
            law,
            solved: residual <= allowed_residual,
        }
    }
}
