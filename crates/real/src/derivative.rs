//! Gradients, directional derivatives and Jacobians by dual numbers.

use crate::{Dual, Real};

/// A scalar function of D numbers, generic over [`Real`].
///
/// This is a trait because a closure cannot be generic over the number type. Closures are also not
/// reliably inlined into a vectorised loop.
pub trait ScalarFunction<const D: usize> {
    /// f(y).
    fn value<R: Real>(&self, y: [R; D]) -> R;
}

/// A vector function ℝᴰ → ℝᴷ, generic over [`Real`].
pub trait VectorFunction<const D: usize, const K: usize> {
    /// f(y).
    fn value<R: Real>(&self, y: [R; D]) -> [R; K];
}

/// ∇f(y), by D evaluations on dual numbers.
#[inline(always)]
pub fn gradient<R: Real, F: ScalarFunction<D>, const D: usize>(f: &F, y: [R; D]) -> [R; D] {
    let mut gradient = [R::zero(); D];
    for i in 0..D {
        let mut seeded = [Dual::fixed(R::zero()); D];
        for j in 0..D {
            seeded[j] = Dual::fixed(y[j]);
        }
        seeded[i].derivative = R::one();
        gradient[i] = f.value(seeded).derivative;
    }
    gradient
}

/// (f(y), f′(y)·v), by one evaluation on dual numbers.
#[inline(always)]
pub fn directional<R: Real, F: VectorFunction<D, K>, const D: usize, const K: usize>(
    f: &F,
    y: [R; D],
    v: [R; D],
) -> ([R; K], [R; K]) {
    let mut seeded = [Dual::fixed(R::zero()); D];
    for j in 0..D {
        seeded[j] = Dual::new(y[j], v[j]);
    }
    let result = f.value(seeded);
    let (mut value, mut slope) = ([R::zero(); K], [R::zero(); K]);
    for i in 0..K {
        value[i] = result[i].value;
        slope[i] = result[i].derivative;
    }
    (value, slope)
}

/// (f(y), f′(y)) by D evaluations on dual numbers. Row i of the K × D matrix f′ is the gradient of
/// component i.
#[inline(always)]
pub fn jacobian<F: VectorFunction<D, K>, const D: usize, const K: usize>(
    f: &F,
    y: [f64; D],
) -> ([f64; K], [[f64; D]; K]) {
    let (mut value, mut jacobian) = ([0.0; K], [[0.0; D]; K]);
    // Up to three columns are written out. The compiler unrolls a loop with a long body too late
    // for the enclosing loop over paths to be vectorised.
    if D > 0 {
        (value, jacobian) = with_column(f, y, jacobian, 0);
    }
    if D > 1 {
        (value, jacobian) = with_column(f, y, jacobian, 1);
    }
    if D > 2 {
        (value, jacobian) = with_column(f, y, jacobian, 2);
    }
    for j in 3..D {
        (value, jacobian) = with_column(f, y, jacobian, j);
    }
    (value, jacobian)
}

/// f(y) and the Jacobian with column j filled in.
#[inline(always)]
fn with_column<F: VectorFunction<D, K>, const D: usize, const K: usize>(
    f: &F,
    y: [f64; D],
    mut jacobian: [[f64; D]; K],
    j: usize,
) -> ([f64; K], [[f64; D]; K]) {
    let mut seed = [0.0; D];
    seed[j] = 1.0;
    let (value, column) = directional(f, y, seed);
    for i in 0..K {
        jacobian[i][j] = column[i];
    }
    (value, jacobian)
}
