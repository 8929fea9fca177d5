//! The conformal exponential integrator with Lévy areas.

use noise::{BlockNoise, Noise};
use nonlin::{BlockStatus, Solution, Solver};
use real::Block;
use systems::{PoissonSystem, noises_commute};

use crate::{Implicit, Increment, Scheme, Sexp, Step};

/// The conformal exponential integrator with Lévy areas, `sexp-levy`: strong order 1 for any number
/// of noises.
///
/// With ẑ = e^{−∫γ, first half} y_n, z̄ = (ẑ+z)/2 and the Lévy areas A_ml of the step,
///
/// z = ẑ + B(z̄) ∇̄h(ẑ, z) + Σ_{m<l} Â_ml \[fₘ, f_l\](z̄),  y_{n+1} = e^{−∫γ, second half} z,
///
/// where fₘ = B∇Hₘ and [f, g] = g′f − f′g. The sum is what the step of [`Sexp`] lacks of the
/// Stratonovich–Taylor expansion of order 1 (Kloeden and Platen 1992, §5.5): Σ f_l′fₘ J_ml with
/// J = ½ΔWΔWᵀ + A, of which the symmetric half is in the averaged gradient already. It is tangent to
/// the level sets of every Casimir C, since [fₘ, f_l]C = fₘ(f_l C) − f_l(fₘ C) = 0 at every point,
/// Jacobi's identity or not; so linear and quadratic Casimirs keep their damped law exactly, as with
/// `Sexp`. A homogeneous energy is kept with one noise, where there is no area. Areas are truncated
/// like increments, so that the equation stays solvable ([`noise::Truncation::area_bound`]).
///
/// Where the noises commute no areas are read, and a step is one of [`Sexp`] and costs as much.
#[derive(Clone, Copy, Debug)]
pub struct SexpLevy {
    /// How the implicit equation is solved.
    pub solver: Solver,
    commuting: bool,
}

impl SexpLevy {
    /// The scheme for a system whose noises commute around `y0`, or do not
    /// ([`systems::noises_commute`]).
    #[must_use]
    pub fn new<S, const D: usize, const M: usize>(system: &S, y0: [f64; D]) -> Self
    where
        S: PoissonSystem<D, M>,
    {
        Self { solver: Solver::default(), commuting: noises_commute(system, y0) }
    }

    /// Whether the noises were found to commute.
    #[must_use]
    pub fn commuting(&self) -> bool {
        self.commuting
    }
}

/// The formula where noises do not commute.
struct WithAreas {
    solver: Solver,
}

impl Implicit for WithAreas {
    const ID: &'static str = "sexp-levy";
    const READS_AREAS: bool = true;
    const EXACT_DAMPING: bool = true;

    #[inline(always)]
    fn psi<H: Increment>(&self, h: H, start: H::Vector, z: H::Vector) -> H::Vector {
        (h.averaged_field(start, z) + h.commutators((z + start) * 0.5)) + start
    }

    fn solver(&self) -> Solver {
        self.solver
    }
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Scheme<S, D, M> for SexpLevy {
    fn id(&self) -> &'static str {
        WithAreas::ID
    }

    fn reads_areas(&self) -> bool {
        M > 1 && !self.commuting
    }

    fn clips_increments(&self) -> bool {
        true
    }

    fn step_block(
        &self,
        system: &S,
        step: &Step,
        noise: &BlockNoise<M>,
        y: &mut Block<D>,
        status: &mut BlockStatus,
    ) {
        if Scheme::<S, D, M>::reads_areas(self) {
            WithAreas { solver: self.solver }.step_block(system, step, noise, y, status);
        } else {
            Sexp { solver: self.solver }.step_block(system, step, noise, y, status);
        }
    }

    fn step(&self, system: &S, step: &Step, noise: &Noise<M>, y: [f64; D]) -> Solution<D> {
        if Scheme::<S, D, M>::reads_areas(self) {
            WithAreas { solver: self.solver }.step(system, step, noise, y)
        } else {
            Sexp { solver: self.solver }.step(system, step, noise, y)
        }
    }
}
