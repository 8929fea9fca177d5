//! Gradients and directional derivatives by dual numbers.

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
    let mut seeded = fixed(y);
    seeded[j] = DualNumber::variable(y[j]);
    seeded
}

/// y as dual numbers with the derivative v: f of them has the derivative f′(y)·v.
#[inline(always)]
pub fn along<R: Real, const D: usize>(y: [R; D], v: [R; D]) -> [Dual<R>; D] {
    let mut seeded = [Dual::<R>::fixed(R::zero()); D];
    for i in 0..D {
        seeded[i] = Dual::new(y[i], v[i]);
    }
    seeded
}

/// y as dual numbers that do not vary.
#[inline(always)]
pub fn fixed<R: Real, V: Variation, const D: usize>(y: [R; D]) -> [DualNumber<R, V>; D] {
    let mut fixed = [DualNumber::<R, V>::fixed(R::zero()); D];
    for i in 0..D {
        fixed[i] = DualNumber::fixed(y[i]);
    }
    fixed
}

/// The derivatives of dual numbers.
#[inline(always)]
pub fn derivatives<R: Real, V: Variation, const D: usize>(y: [DualNumber<R, V>; D]) -> [R; D] {
    let mut derivatives = [R::zero(); D];
    for i in 0..D {
        derivatives[i] = y[i].derivative();
    }
    derivatives
}
