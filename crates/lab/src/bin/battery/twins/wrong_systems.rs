//! Systems with one mistake.

use real::Real;
use systems::{Invariant, PoissonSystem};

/// The last component of B(y)v has the wrong sign: B is no longer skew.
pub struct SignError<S>(pub S);

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> PoissonSystem<D, M> for SignError<S> {
    fn name(&self) -> &'static str {
        self.0.name()
    }
    #[inline(always)]
    fn structure<R: Real>(&self, y: [R; D], v: [R; D]) -> [R; D] {
        let mut product = self.0.structure(y, v);
        product[D - 1] = -product[D - 1];
        product
    }
    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; M]) -> R {
        self.0.energy(y, dt, dw)
    }
    fn invariants(&self) -> Vec<Invariant> {
        self.0.invariants()
    }
    fn invariant<R: Real>(&self, index: usize, y: [R; D]) -> R {
        self.0.invariant(index, y)
    }
}

/// The discrete gradient is the gradient at the midpoint.
pub struct MidpointGradient<S>(pub S);

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> PoissonSystem<D, M>
    for MidpointGradient<S>
{
    fn name(&self) -> &'static str {
        self.0.name()
    }
    #[inline(always)]
    fn structure<R: Real>(&self, y: [R; D], v: [R; D]) -> [R; D] {
        self.0.structure(y, v)
    }
    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; M]) -> R {
        self.0.energy(y, dt, dw)
    }
    #[inline(always)]
    fn averaged_gradient<R: Real>(&self, a: [R; D], b: [R; D], dt: f64, dw: [f64; M]) -> [R; D] {
        self.0.gradient(dgrad::midpoint(a, b), dt, dw)
    }
    fn invariants(&self) -> Vec<Invariant> {
        self.0.invariants()
    }
    fn invariant<R: Real>(&self, index: usize, y: [R; D]) -> R {
        self.0.invariant(index, y)
    }
}
