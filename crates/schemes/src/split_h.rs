//! Flows in turn along a path that has the space-time areas of the noise.

use real::unrolled;
use systems::{
    Flows,
    run_time::{Description, System},
};

use crate::{Composition, Paths, Step, Times, baoab::Friction};

/// Splitting of strong order 1.5 or 2 for noises that commute, `split-h`.
///
/// With the space-time areas H, τ(½ΔW + H) = ∫W ds, the flow N(w) of Σ wₘHₘ, a symmetric step D(t)
/// of H₀ with exact damping, and δ = ΔW/√6,
///
/// y_{n+1} = N(½ΔW − H − δ) D(τ/2) N(2δ) D(τ/2) N(½ΔW + H − δ) y_n.
///
/// The factors follow a path of straight pieces in (t, W) that has ΔW and ∫W ds of the noise and
/// ∫W² ds in the mean (Foster, dos Reis and Strange, *SIAM J. Numer. Anal.* 62, 2024, for such
/// paths; conformal damping and Casimirs: here). Where fields fₘ are constant and f₀ has no second
/// derivatives along them, as in Langevin dynamics, ∫W² ds has no part in the error, and δ = 0 with
/// one step D(τ) does.
///
/// - Orders: strong 1.5, and 2 with δ = 0; weak 2; order 2 without noise. Noises must commute, and
///   Hamiltonians not depend on time.
/// - Preserves the conformal law of every homogeneous Casimir that its flows preserve, for every τ
///   and every increment.
/// - Cost per step: 4P + 7 flows, 2P + 4 with δ = 0. Explicit.
#[derive(Clone)]
pub struct SplitH {
    /// Rates of friction, and the components that each damps.
    pub friction: Vec<Friction>,
    /// δ over ΔW.
    pub delta: f64,
}

impl SplitH {
    /// δ = ΔW/√6, for friction on components besides the damping of all of them.
    pub fn new(friction: impl IntoIterator<Item = Friction>) -> Self {
        Self { friction: friction.into_iter().collect(), delta: (1.0f64 / 6.0).sqrt() }
    }

    /// The scheme with δ = 0 where the system is [of Langevin's
    /// kind](systems::run_time::Description::is_langevin).
    pub fn of(system: &dyn System, friction: impl IntoIterator<Item = Friction>) -> Self {
        let new = Self::new(friction);
        if system.description().is_langevin { Self { delta: 0.0, ..new } } else { new }
    }

    /// The flow of all noises for shares of increments and areas.
    #[inline(always)]
    fn kick<S: Flows<D, M>, const D: usize, const M: usize, const N: usize>(
        paths: &mut Paths<'_, S, D, M, N>,
        shares: [f64; 2],
    ) {
        unrolled!(f64: m in 0..M => { paths.noise(m, Times::with_area(m, shares)); });
    }

    /// All damping of a half of the step, 0 or 1.
    #[inline(always)]
    fn damp<S, const D: usize, const M: usize, const N: usize>(
        &self,
        step: &Step,
        half: u64,
        paths: &mut Paths<'_, S, D, M, N>,
    ) {
        paths.scale([step.first_decay, step.second_decay][half as usize]);
        for (damping, components) in &self.friction {
            let decay = step.decay(&**damping, half);
            components.iter().for_each(|&i| paths.scale_one(i, decay));
        }
    }
}

impl<S: Flows<D, M>, const D: usize, const M: usize> Composition<S, D, M> for SplitH {
    const ID: &'static str = "split-h";
    const READS_SPACE_TIME: bool = true;

    #[inline(always)]
    fn compose<const N: usize>(&self, step: &Step, paths: &mut Paths<'_, S, D, M, N>) {
        let (delta, quarter) = (self.delta, Times::drift(0.25 * step.tau));
        Self::kick(paths, [0.5 - delta, 1.0]);
        for half in 0..2 {
            paths.in_turn(quarter, false);
            self.damp(step, half, paths);
            paths.in_turn(quarter, true);
            if half == 0 {
                Self::kick(paths, [2.0 * delta, 0.0]);
            }
        }
        Self::kick(paths, [0.5 - delta, -1.0]);
    }
}

/// Scheme along the path of [`SplitH`] with the step of [`Sexp`](crate::Sexp) without noise for
/// each D, `sexp-h`, for systems known at run time: H₀ needs no flows. A noise whose flow is not
/// known is a triple jump of the noise step of [`Sexp`](crate::Sexp).
///
/// - Orders: those of [`SplitH`].
/// - Preserves the conformal laws of linear and quadratic Casimirs; a homogeneous H₀ with one noise
///   H₁ = cH₀; the energy without noise.
/// - Cost per step: two systems of D equations, one with δ = 0, and those of noises without flows.
/// - Increments are truncated if a noise has no flow.
#[derive(Clone)]
pub struct SexpH {
    pub(crate) path: SplitH,
    pub(crate) clips: bool,
}

impl SexpH {
    /// The scheme with the δ of [`SplitH::of`].
    pub fn of(system: &dyn System, friction: impl IntoIterator<Item = Friction>) -> Self {
        let Description { parts, noises, .. } = system.description();
        let flows = parts.as_ref().map_or(0, |parts| parts.of_noise.iter().flatten().count());
        Self { path: SplitH::of(system, friction), clips: flows < *noises }
    }
}
