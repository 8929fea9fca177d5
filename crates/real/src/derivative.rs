//! Gradients, directional derivatives and Jacobians by dual numbers.

use crate::{Dual, DualNumber, Real, Variation, Varies};

/// `unrolled!(R: i in 0..N => { … })`: the loop over i, written out for up to eight turns if R is
/// nested at most once, else with the body behind `else`, if there is one. The compiler unrolls a
/// loop with a long body too late for the enclosing loop over paths to be vectorised, and too late
/// to see which numbers vary.
#[macro_export]
macro_rules! unrolled {
    ($number:ty: $i:ident in 0..$n:expr => $body:block) => {
        $crate::unrolled!($number: $i in 0..$n => $body else $body)
    };
    ($number:ty: $i:ident in 0..$n:expr => $body:block else $looped:block) => {
        if const { $crate::is_written_out::<$number>($n) } {
            $crate::unrolled!($i, $n, $body, 0 1 2 3 4 5 6 7);
        } else {
            for $i in 0..$n $looped
        }
    };
    ($i:ident, $n:expr, $body:block, $($turn:literal)*) => {
        $(if const { $n > $turn } {
            let $i = $turn;
            $body
        })*
    };
}

/// Whether [`unrolled!`] writes out a loop of n turns over numbers R.
pub const fn is_written_out<R: Real>(n: usize) -> bool {
    n <= 8 && R::DEPTH <= 1
}

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

/// ∇f(y), by D evaluations on dual numbers that depend on one component each.
#[inline(always)]
pub fn gradient<R: Real, F: ScalarFunction<D>, const D: usize>(f: &F, y: [R; D]) -> [R; D] {
    let mut gradient = [R::zero(); D];
    unrolled!(R: i in 0..D => {
        gradient[i] = f.value(seeded::<R, bool, D>(y, i)).derivative();
    } else {
        gradient[i] = f.value(seeded::<R, Varies, D>(y, i)).derivative();
    });
    gradient
}

/// y as dual numbers, of which component j has derivative 1.
#[inline(always)]
pub fn seeded<R: Real, V: Variation, const D: usize>(y: [R; D], j: usize) -> [DualNumber<R, V>; D] {
    let mut seeded = [DualNumber::<R, V>::fixed(R::zero()); D];
    for i in 0..D {
        seeded[i] = DualNumber::fixed(y[i]);
    }
    seeded[j] = DualNumber::variable(y[j]);
    seeded
}

/// (f(y), f′(y)·v), by one evaluation on dual numbers.
#[inline(always)]
pub fn directional<R: Real, F: VectorFunction<D, K>, const D: usize, const K: usize>(
    f: &F,
    y: [R; D],
    v: [R; D],
) -> ([R; K], [R; K]) {
    let mut seeded = [Dual::<R>::fixed(R::zero()); D];
    for j in 0..D {
        seeded[j] = Dual::new(y[j], v[j]);
    }
    let result = f.value(seeded);
    let (mut value, mut slope) = ([R::zero(); K], [R::zero(); K]);
    for i in 0..K {
        value[i] = result[i].value;
        slope[i] = result[i].derivative();
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
    // Up to three columns are written out. For more, code that is written out takes long to
    // compile.
    if const { D <= 3 } {
        unrolled!(f64: j in 0..D => {
            (value, jacobian) = with_column::<Varies, _, D, K>(f, y, jacobian, j);
        });
    } else {
        for j in 0..D {
            (value, jacobian) = with_column::<Varies<2>, _, D, K>(f, y, jacobian, j);
        }
    }
    (value, jacobian)
}

/// f(y) and the Jacobian with column j filled in.
#[inline(always)]
fn with_column<V: Variation, F: VectorFunction<D, K>, const D: usize, const K: usize>(
    f: &F,
    y: [f64; D],
    mut jacobian: [[f64; D]; K],
    j: usize,
) -> ([f64; K], [[f64; D]; K]) {
    let result = f.value(seeded::<f64, V, D>(y, j));
    let mut value = [0.0; K];
    for i in 0..K {
        value[i] = result[i].value;
        jacobian[i][j] = result[i].derivative();
    }
    (value, jacobian)
}
