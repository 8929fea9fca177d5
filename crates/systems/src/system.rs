//! The trait of Poisson systems.

use dgrad::{averaged_by_degree, midpoint};
use real::{Degree, Real, Segment, gradient, unrolled};

use crate::{
    Invariant, SystemError,
    cayley::cayley_by_elimination,
    field::{HamiltonianIncrement, degree, unit_noise, vector_field, vector_field_derivative},
};

/// A stochastic Poisson system in D dimensions with M noises, dy = B∇H₀ dt + Σₘ B∇Hₘ ∘ dWₘ
/// (Stratonovich). The damping is given separately, as a [`Damping`](crate::Damping).
///
/// Two formulas define a system: B(y)·v in [`structure`](Self::structure) and the Hamiltonian
/// increment h in [`energy`](Self::energy). Everything else follows from them. Override a method to
/// give a closed form that is faster or more accurate.
///
/// Mark implementations `#[inline(always)]` and avoid branches, so that blocks are vectorised. Time
/// and noise increments are `f64`: no derivative with respect to them is needed, and constants
/// outside of the dual numbers save multiplications in every Jacobian.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a system dy = (B∇H₀ − γy) dt + Σ B∇Hₘ ∘ dWₘ with D = {D}, M = {M}",
    note = "implement `PoissonSystem<{D}, {M}>`: B(y)v and h = H₀ dt + Σ Hₘ dWₘ"
)]
pub trait PoissonSystem<const D: usize, const M: usize>: Send + Sync + Sized {
    /// The name of the system in reports.
    fn name(&self) -> &'static str;

    /// The parameters of the system in reports, for example `c = 0.5`; empty unless overridden.
    fn parameters(&self) -> String {
        String::new()
    }

    /// B(y)·v, with B(y) skew-symmetric.
    fn structure<R: Real>(&self, y: [R; D], v: [R; D]) -> [R; D];

    /// The Hamiltonian increment h(y) = H₀(y)·dt + Σₘ Hₘ(y)·dwₘ. It must be linear in (dt, dw).
    fn energy<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; M]) -> R;

    /// ∇h(y); by dual numbers unless overridden.
    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; M]) -> [R; D] {
        gradient(&HamiltonianIncrement { system: self, dt, dw }, y)
    }

    /// ∇̄h(a, b) = ∫₀¹ ∇h((1−η)a + ηb) dη. Unless overridden it is ∇h((a+b)/2) for polynomials h of
    /// degree two, the closed form of a [`Segment`] where there is one, and else by Gauss–Legendre
    /// nodes: as many as a polynomial of degree six or less needs, or 8.
    #[inline(always)]
    fn averaged_gradient<R: Real>(&self, a: [R; D], b: [R; D], dt: f64, dw: [f64; M]) -> [R; D] {
        let (field, degree) = (HamiltonianIncrement { system: self, dt, dw }, degree(self, dt, dw));
        let (mut mean, mut known) = (a, degree > Degree::of(2));
        if known {
            let mut segment = [Segment::zero(); D];
            for i in 0..D {
                segment[i] = Segment::new(a[i], b[i]);
            }
            let along = self.gradient(segment, dt, dw);
            for i in 0..D {
                match along[i].mean() {
                    Some(slope) => mean[i] = slope,
                    None => known = false,
                }
            }
        }
        if known { mean } else { averaged_by_degree(&field, degree, a, b) }
    }

    /// B((a+b)/2)·∇̄h(a, b), the change over an implicit step from a to b; by
    /// [`structure`](Self::structure) and [`averaged_gradient`](Self::averaged_gradient) unless
    /// overridden.
    #[inline(always)]
    fn averaged_field<R: Real>(&self, a: [R; D], b: [R; D], dt: f64, dw: [f64; M]) -> [R; D] {
        self.structure(midpoint(a, b), self.averaged_gradient(a, b, dt, dw))
    }

    /// The solution of z = y + B((y+z)/2)·v, for B that is affine in y: a linear equation, solved
    /// by elimination unless overridden. Not finite where the equation has no solution.
    ///
    /// Every quadratic Casimir C has C(z) = C(y), whatever v is.
    #[inline(always)]
    fn cayley<R: Real>(&self, y: [R; D], v: [R; D]) -> [R; D] {
        cayley_by_elimination(self, y, v)
    }

    /// Σ_{m<l} A_ml \[fₘ, f_l\](y) for a skew matrix A of Lévy areas, with fₘ = B∇Hₘ and [f, g] =
    /// g′f − f′g; by dual numbers unless overridden. This field is tangent to the level sets of
    /// every Casimir C, since [fₘ, f_l]C = fₘ(f_l C) − f_l(fₘ C) = 0.
    #[inline(always)]
    fn commutators<R: Real>(&self, y: [R; D], areas: [[f64; M]; M]) -> [R; D] {
        // Σ_l f_l′g_l with g_l = Σₘ A_ml fₘ takes one directional derivative per noise.
        let mut sum = [R::zero(); D];
        if M < 2 {
            return sum;
        }
        unrolled!(R: l in 0..M => {
            let mut weights = [0.0; M];
            for m in 0..M {
                weights[m] = areas[m][l];
            }
            let direction = vector_field(self, y, 0.0, weights);
            let derivative = vector_field_derivative(self, y, 0.0, unit_noise(l), direction);
            for i in 0..D {
                sum[i] = sum[i] + derivative[i];
            }
        });
        sum
    }

    /// The functions that obey the conformal law: homogeneous Casimirs and, for H₁ = cH₀ as the
    /// only noise, a homogeneous Hamiltonian. Empty unless overridden.
    fn invariants(&self) -> Vec<Invariant> {
        Vec::new()
    }

    /// The value of `invariants()[index]` at y.
    ///
    /// # Panics
    /// Unless `index < invariants().len()`.
    fn invariant<R: Real>(&self, index: usize, y: [R; D]) -> R {
        let _ = y;
        no_invariant(self.name(), index)
    }

    /// Checks that y is in the domain of the system, which is all of ℝᴰ unless overridden.
    ///
    /// # Errors
    /// [`SystemError`] with the component and the domain.
    fn check_domain(&self, y: [f64; D]) -> Result<(), SystemError> {
        let _ = y;
        Ok(())
    }

    /// The fastest method for implicit steps of this system. Every choice gives the same solutions
    /// up to round-off.
    const IMPLICIT_STEP: ImplicitStep = ImplicitStep::FixedPoint;

    /// For [`ImplicitStep::Predicted`]: a prediction b of the solution of b = a + averaged_field(a,
    /// b), and a bound of its residual ‖b − a − averaged_field(a, b)‖₁ in exact arithmetic.
    ///
    /// If the bound is below the tolerance, the prediction is accepted. If the bound is larger but
    /// finite, Newton's method starts from the prediction; otherwise it starts from a. The
    /// prediction must lie on the branch that tends to a as dt and dw tend to zero.
    ///
    /// Take functions from [`elementary`](real::elementary): `f64::sin` is the platform's, which
    /// has other bits on other machines and is not vectorised.
    #[inline(always)]
    fn predict(&self, a: [f64; D], dt: f64, dw: [f64; M]) -> ([f64; D], f64) {
        let _ = (dt, dw);
        (a, f64::INFINITY)
    }
}

/// The method for the implicit steps of a system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImplicitStep {
    /// Fixed-point iteration, suitable for every system.
    FixedPoint,
    /// Fixed-point iteration with the first eleven evaluations written out for two paths at a time.
    /// It is a third faster if [`averaged_field`](PoissonSystem::averaged_field) is a closed form
    /// of some dozen operations. With a quadrature it is too much code.
    UnrolledFixedPoint,
    /// Newton's method, the faster one if ∇̄h is costly, with sines or exponentials.
    Newton,
    /// [`predict`](PoissonSystem::predict), and Newton's method where the prediction is not
    /// accurate enough.
    Predicted,
}

/// Panics for an index beyond the invariants of a system.
pub fn no_invariant(system: &str, index: usize) -> ! {
    panic!("{system} has no invariant of index {index}")
}
