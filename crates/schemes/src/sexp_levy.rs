//! The stochastic conformal exponential integrator with Lévy areas.

use systems::{
    PoissonSystem, noises_commute,
    run_time::{self, Description},
};

use crate::{Implicit, Increment, SchemeError};

/// The stochastic conformal exponential integrator with Lévy areas, `sexp-levy`: an extension of
/// [`Sexp`](crate::Sexp) (Bréhier, Cohen and Komori 2025) with strong order 1 for any number of
/// noises.
///
/// With ẑ = e^{−∫γ, first half} y_n, z̄ = (ẑ+z)/2 and the truncated Lévy areas Â_ml of the step,
///
/// z = ẑ + B(z̄) ∇̄h(ẑ, z) + Σ_{m<l} Â_ml \[fₘ, f_l\](z̄),  y_{n+1} = e^{−∫γ, second half} z,
///
/// where fₘ = B∇Hₘ and [f, g] = g′f − f′g. The Stratonovich–Taylor expansion of order 1 has the
/// term Σ f_l′fₘ J_ml with J = ½ΔWΔWᵀ + A (Kloeden and Platen 1992, §5.5). The averaged gradient
/// contains its symmetric part, and the sum over areas is the skew part. It is tangent to the level
/// sets of every Casimir C, since [fₘ, f_l]C = fₘ(f_l C) − f_l(fₘ C) = 0. Areas are truncated like
/// increments ([`noise::Truncation::area_bound`]), so that the equation remains solvable.
///
/// - Orders: strong 1, weak 1.
/// - Preserves the same conformal laws as [`Sexp`](crate::Sexp).
/// - Cost per step: one nonlinear system of D equations, the commutators in every evaluation, and
///   the Lévy areas. If the noises commute, no areas are read and a step is one of
///   [`Sexp`](crate::Sexp).
#[derive(Clone, Copy, Debug)]
pub struct SexpLevy {
    commuting: bool,
}

impl SexpLevy {
    /// The scheme for `system`. [`systems::noises_commute`] checks around `y0` whether areas are
    /// needed.
    pub fn new<S, const D: usize, const M: usize>(system: &S, y0: [f64; D]) -> Self
    where
        S: PoissonSystem<D, M>,
    {
        Self { commuting: noises_commute(system, y0) }
    }

    /// The scheme for a system known at run time, which says whether its noises commute.
    ///
    /// # Errors
    /// [`SchemeError`] if they do not, unless the system
    /// [shows the identity](run_time::Description::jacobi_holds).
    pub fn at_run_time(system: &dyn run_time::System) -> Result<Self, SchemeError> {
        let Description { name, noises_commute, jacobi_holds, .. } = system.description();
        if !(noises_commute | jacobi_holds) {
            return Err(SchemeError::jacobi(WithAreas::ID, name));
        }
        Ok(Self { commuting: *noises_commute })
    }

    /// Whether the noises commute, so that the scheme reads no areas.
    pub fn commuting(&self) -> bool {
        self.commuting
    }
}

/// The formula for noises that do not commute.
pub struct WithAreas;

impl Implicit for WithAreas {
    const ID: &'static str = "sexp-levy";
    const READS_AREAS: bool = true;
    const EXACT_DAMPING: bool = true;

    #[inline(always)]
    fn psi<H: Increment>(&self, h: H, start: H::Vector, z: H::Vector) -> H::Vector {
        (h.averaged_field(start, z) + h.commutators((z + start) * 0.5)) + start
    }
}
