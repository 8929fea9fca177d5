//! The equation z = ψ(z).

use real::{Real, VectorFunction, jacobian};

use crate::Method;

/// One equation z = ψ(z) in D unknowns.
pub trait FixedPoint<const D: usize>: Copy {
    /// The method that solves it with the least work, taken by a [`Solver`](crate::Solver) that is
    /// not told another.
    const METHOD: Method = Method::FixedPoint;

    /// How that method begins.
    const FIRST_SWEEP: FirstSweep = FirstSweep::Plain;

    /// Where iterations start. For an implicit step this is the state before the step, to which the
    /// solution shrinks with the step; continuation follows the branch that starts here.
    fn start(&self) -> [f64; D];

    /// ψ(z). Must be `#[inline(always)]` and free of branches to run fast in a block.
    fn map<R: Real>(&self, z: [R; D]) -> [R; D];

    /// ψ(z) and the Jacobian ψ′(z), row i holding ∂ψᵢ/∂zⱼ, by dual numbers.
    #[inline(always)]
    fn jacobian(&self, z: [f64; D]) -> ([f64; D], [[f64; D]; D]) {
        jacobian(&Map(*self), z)
    }

    /// A prediction of the solution, on the branch that starts at the start, and a bound of its
    /// residual ‖z − ψ(z)‖₁, rounding excepted; for [`FirstSweep::Predicted`]. Where the bound is
    /// infinite or NaN the prediction is not used.
    #[inline(always)]
    fn predict(&self) -> ([f64; D], f64) {
        (self.start(), f64::INFINITY)
    }
}

/// How the iteration for an equation begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FirstSweep {
    /// Like every other sweep.
    Plain,
    /// Eleven evaluations of ψ, or two steps of Newton's method from ψ(ψ(start)), written out for
    /// two paths at a time. Fast where ψ is a few dozen operations, and long code to compile where
    /// it is not.
    Long,
    /// [`FixedPoint::predict`], accepted if its residual bound is below the tolerance. If not, sweeps
    /// of the method start from the prediction.
    Predicted,
}

/// ψ as a function.
struct Map<E>(E);

impl<E: FixedPoint<D>, const D: usize> VectorFunction<D, D> for Map<E> {
    #[inline(always)]
    fn value<R: Real>(&self, z: [R; D]) -> [R; D] {
        self.0.map(z)
    }
}

/// The equations of a block of paths. They are copied where a path needs the robust method, so let
/// them borrow what is large.
pub trait BlockFixedPoint<const D: usize>: Copy {
    /// The equation of one path.
    type Path: FixedPoint<D>;
    /// The equation of path `p`. Must be `#[inline(always)]`.
    fn path(&self, p: usize) -> Self::Path;
}
