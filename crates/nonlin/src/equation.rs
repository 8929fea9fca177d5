//! The equation z = ψ(z).

use real::{Real, VectorFunction, jacobian};

use crate::Method;

/// One equation z = ψ(z) in D unknowns.
pub trait FixedPoint<const D: usize>: Copy {
    /// The method that solves it with the least work, taken by a [`Solver`](crate::Solver) that is not told another.
    const METHOD: Method = Method::FixedPoint;

    /// Whether that method begins with a long first sweep, written out for two paths at a time: eleven evaluations of ψ, or two
    /// steps of Newton's method from a prediction. Fast where ψ is a few dozen operations, and long code to compile where it is
    /// not; without it all sweeps are alike.
    const LONG_FIRST_SWEEP: bool = false;

    /// Where iterations start. For an implicit step this is the state before the step, to which the solution
    /// shrinks with the step; continuation follows the branch that starts here.
    fn start(&self) -> [f64; D];

    /// ψ(z). Must be `#[inline(always)]` and free of branches to run fast in a block.
    fn map<R: Real>(&self, z: [R; D]) -> [R; D];

    /// ψ(z) and the Jacobian ψ′(z), row i holding ∂ψᵢ/∂zⱼ, by dual numbers.
    #[inline(always)]
    fn jacobian(&self, z: [f64; D]) -> ([f64; D], [[f64; D]; D]) {
        jacobian(&Map(*self), z)
    }

    /// A guess of the solution, from which Newton's method sets out; two evaluations unless overridden.
    #[inline(always)]
    fn predictor(&self) -> [f64; D] {
        self.map(self.map(self.start()))
    }

    /// [`map`](FixedPoint::map) where z is near the start, NaN where it is too far away: the first sweep of Newton's method calls
    /// this, and the second one starts again with `map` if it met a NaN.
    #[inline(always)]
    fn map_near(&self, z: [f64; D]) -> [f64; D] {
        self.map(z)
    }

    /// [`jacobian`](FixedPoint::jacobian) where z is near the start, NaN where it is too far away.
    #[inline(always)]
    fn jacobian_near(&self, z: [f64; D]) -> ([f64; D], [[f64; D]; D]) {
        self.jacobian(z)
    }
}

/// ψ as a function.
struct Map<E>(E);

impl<E: FixedPoint<D>, const D: usize> VectorFunction<D, D> for Map<E> {
    #[inline(always)]
    fn value<R: Real>(&self, z: [R; D]) -> [R; D] {
        self.0.map(z)
    }
}

/// The equations of a block of paths.
pub trait BlockFixedPoint<const D: usize> {
    /// The equation of one path.
    type Path: FixedPoint<D>;
    /// The equation of path `p`. Must be `#[inline(always)]`.
    fn path(&self, p: usize) -> Self::Path;
}
