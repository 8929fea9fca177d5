//! The trait that a system is written in.

use dgrad::{averaged, quadratic};
use real::{Real, gradient};

use crate::field::{Energy, HamiltonianIncrement, commutators};
use crate::{Invariant, SystemError};

/// Nodes of the default discrete gradient: error of order |b − a|¹⁶, round-off for the small steps
/// of a scheme.
const DEFAULT_NODES: usize = 8;

/// A damped stochastic Poisson system in D dimensions with M noises, less its damping.
///
/// Two formulas are asked for. Everything provided follows from them and may be overridden by a
/// closed form that is faster or more accurate. Implementations must be `#[inline(always)]` and
/// free of branches to run fast in a block of paths. Time and noise increments are plain numbers:
/// nothing is ever differentiated by them, and constants kept out of the dual numbers are
/// multiplications saved in every Jacobian.
pub trait PoissonSystem<const D: usize, const M: usize>: Send + Sync {
    /// Whether schemes solve their steps by Newton's method unless told otherwise: the faster one
    /// where ∇̄h is costly.
    const PREFERS_NEWTON: bool = false;

    /// Whether [`averaged_field`](PoissonSystem::averaged_field) is a closed form of some dozen
    /// operations. Then the fixed-point iteration begins with eleven evaluations that are written
    /// out for two paths at a time: a third faster, and too much code where the field is a
    /// quadrature.
    const SHORT_FIELD: bool = false;

    /// Whether [`short_step`](PoissonSystem::short_step) solves the implicit steps that are not too
    /// long.
    const SOLVES_SHORT_STEPS: bool = false;

    /// Its name in reports.
    fn name(&self) -> &'static str;

    /// B(y)·v, with B(y) skew-symmetric.
    fn structure<R: Real>(&self, y: [R; D], v: [R; D]) -> [R; D];

    /// The Hamiltonian increment h(y) = H₀(y)·dt + Σₘ Hₘ(y)·dwₘ, linear in (dt, dw).
    fn energy<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; M]) -> R;

    /// ∇h(y); by dual numbers unless overridden.
    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; M]) -> [R; D] {
        gradient(&Energy { system: self, dt, dw }, y)
    }

    /// ∇̄h(a, b) = ∫₀¹ ∇h((1−η)a + ηb) dη; by 8 Gauss–Legendre nodes unless overridden.
    #[inline(always)]
    fn averaged_gradient<R: Real>(&self, a: [R; D], b: [R; D], dt: f64, dw: [f64; M]) -> [R; D] {
        averaged::<DEFAULT_NODES, R, _, D>(&HamiltonianIncrement { system: self, dt, dw }, a, b)
    }

    /// B((a+b)/2)·∇̄h(a, b), the change over an implicit step from a to b; composed of the two
    /// unless overridden.
    #[inline(always)]
    fn averaged_field<R: Real>(&self, a: [R; D], b: [R; D], dt: f64, dw: [f64; M]) -> [R; D] {
        self.structure(quadratic(a, b), self.averaged_gradient(a, b, dt, dw))
    }

    /// The b with b = a + averaged_field(a, b), where an implicit step leads, and a bound of what
    /// it lacks of that, ‖b − a − averaged_field(a, b)‖₁, rounding excepted.
    ///
    /// For systems that set [`SOLVES_SHORT_STEPS`](PoissonSystem::SOLVES_SHORT_STEPS): what is
    /// known of an equation, and a general solver cannot know, saves most of its work. If the bound
    /// is not round-off, which the solver decides, its sweeps go on from b; where it is infinite or
    /// NaN they begin at a. There must be no other solution that begins at a for smaller steps than
    /// the one that b is near.
    #[inline(always)]
    fn short_step(&self, a: [f64; D], dt: f64, dw: [f64; M]) -> ([f64; D], f64) {
        let _ = (dt, dw);
        (a, f64::INFINITY)
    }

    /// [`short_step`](PoissonSystem::short_step) for two paths, the same bits. A system whose
    /// solution is a chain of operations that wait for each other takes them in turn here, and two
    /// chains fit into the time of one.
    #[inline(always)]
    fn short_steps(&self, a: [[f64; D]; 2], dt: f64, dw: [[f64; M]; 2]) -> [([f64; D], f64); 2] {
        [self.short_step(a[0], dt, dw[0]), self.short_step(a[1], dt, dw[1])]
    }

    /// Σ_{m<l} A_ml \[fₘ, f_l\](y) for a skew matrix A of Lévy areas, with fₘ = B∇Hₘ and [f, g] =
    /// g′f − f′g; by dual numbers, nested where a Jacobian is wanted, unless overridden. It is
    /// tangent to the level sets of every Casimir: [fₘ, f_l]C = fₘ(f_l C) − f_l(fₘ C) = 0.
    #[inline(always)]
    fn commutators<R: Real>(&self, y: [R; D], areas: [[f64; M]; M]) -> [R; D] {
        commutators(self, y, areas)
    }

    /// The homogeneous Casimirs and, for one noise, the homogeneous Hamiltonian; none unless
    /// overridden.
    fn invariants(&self) -> Vec<Invariant> {
        Vec::new()
    }

    /// The value of `invariants()[index]` at y; NaN for an index that the system does not have.
    fn invariant<R: Real>(&self, index: usize, y: [R; D]) -> R {
        let _ = (index, y);
        R::constant(f64::NAN)
    }

    /// Checks that y is where the system is defined; everywhere unless overridden.
    ///
    /// # Errors
    /// [`SystemError::OutsideDomain`] names the component and the domain.
    fn check_domain(&self, y: [f64; D]) -> Result<(), SystemError> {
        let _ = y;
        Ok(())
    }
}
