//! Systems with a mistake.

use real::Real;
use systems::{Invariant, PoissonSystem};

/// A system whose discrete gradient is the gradient at the midpoint, and whose last component of
/// B(y)v is multiplied by `last`.
///
/// The discrete gradient is a mistake unless the Hamiltonians are quadratic, and so is any factor
/// but 1: with −1, B is no longer skew.
pub struct WrongSystem<S> {
    /// The right system.
    pub right: S,
    /// Factor of the last component.
    pub last: f64,
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> PoissonSystem<D, M>
    for WrongSystem<S>
{
    fn name(&self) -> &'static str {
        self.right.name()
    }
    #[inline(always)]
    fn structure<R: Real>(&self, y: [R; D], v: [R; D]) -> [R; D] {
        let mut product = self.right.structure(y, v);
        product[D - 1] = product[D - 1] * self.last;
        product
    }
    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; M]) -> R {
        self.right.energy(y, dt, dw)
    }
    #[inline(always)]
    fn averaged_gradient<R: Real>(&self, a: [R; D], b: [R; D], dt: f64, dw: [f64; M]) -> [R; D] {
        self.right.gradient(dgrad::midpoint(a, b), dt, dw)
    }
    fn invariants(&self) -> Vec<Invariant> {
        self.right.invariants()
    }
    fn invariant<R: Real>(&self, index: usize, y: [R; D]) -> R {
        self.right.invariant(index, y)
    }
}
