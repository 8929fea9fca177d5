//! The trait that a system is written in.

use dgrad::{averaged, midpoint};
use real::{Real, gradient};

use crate::field::{Energy, HamiltonianIncrement, commutators};
use crate::{Invariant, SystemError};

/// Nodes of the default discrete gradient: error of order |b − a|¹⁶, round-off for the small steps
/// of a scheme.
const DEFAULT_NODES: usize = 8;

/// A damped stochastic Poisson system in D dimensions with M noises, less its damping.
///
/// Two formulas make a system: [`structure`](Self::structure) is B(y)·v, and
/// [`energy`](Self::energy) is the Hamiltonian increment h. Everything else follows from them, and
/// may be overridden by a closed form that is faster or more accurate.
///
/// Implementations must be `#[inline(always)]` and free of branches to run fast in a block of
/// paths. Time and noise increments are plain numbers: nothing is differentiated by them, and
/// constants kept out of the dual numbers save multiplications in every Jacobian.
pub trait PoissonSystem<const D: usize, const M: usize>: Send + Sync {
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
        self.structure(midpoint(a, b), self.averaged_gradient(a, b, dt, dw))
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

    /// The value of `invariants()[index]` at y.
    ///
    /// # Panics
    /// Where there is no invariant of this index.
    fn invariant<R: Real>(&self, index: usize, y: [R; D]) -> R {
        let _ = y;
        no_invariant(self.name(), index)
    }

    /// Checks that y is where the system is defined; everywhere unless overridden.
    ///
    /// # Errors
    /// [`SystemError::OutsideDomain`] names the component and the domain.
    fn check_domain(&self, y: [f64; D]) -> Result<(), SystemError> {
        let _ = y;
        Ok(())
    }

    /// How the implicit steps of the system are solved with the least work. Every choice gives the
    /// same solutions to round-off: this is about speed alone.
    const IMPLICIT_STEP: ImplicitStep = ImplicitStep::FixedPoint;

    /// A prediction of the solution of b = a + averaged_field(a, b), and a bound of its residual
    /// ‖b − a − averaged_field(a, b)‖₁, rounding excepted; for [`ImplicitStep::Predicted`].
    ///
    /// A prediction whose bound is round-off is accepted. One with a larger bound is where Newton's
    /// method starts; without a finite bound it starts at a. The prediction must lie on the branch
    /// of solutions that tends to a as dt and dw tend to zero.
    #[inline(always)]
    fn predict(&self, a: [f64; D], dt: f64, dw: [f64; M]) -> ([f64; D], f64) {
        let _ = (dt, dw);
        (a, f64::INFINITY)
    }
}

/// How the implicit steps of a system are solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImplicitStep {
    /// By fixed-point iteration: right for every system.
    FixedPoint,
    /// The same, with the first eleven evaluations written out for two paths at a time. A third
    /// faster where [`averaged_field`](PoissonSystem::averaged_field) is a closed form of some
    /// dozen operations, and too much code where it is a quadrature.
    UnrolledFixedPoint,
    /// By Newton's method: the faster one where ∇̄h is costly, with sines or exponentials.
    Newton,
    /// By [`predict`](PoissonSystem::predict), and by Newton's method where the prediction is not
    /// accurate enough.
    Predicted,
}

/// For an index beyond the invariants of a system.
pub(crate) fn no_invariant(system: &str, index: usize) -> ! {
    panic!("{system} has no invariant of index {index}")
}
