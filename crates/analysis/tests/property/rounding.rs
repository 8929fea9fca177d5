//! What the checks need of [`real::Bounded`], the number that bounds its own rounding error: where
//! tolerances come from.

use real::Real;

pub use real::Bounded;

/// Half an ulp, relative: the rounding of one operation.
pub const UNIT: f64 = 0.5 * f64::EPSILON;

/// A number that has been rounded once.
pub fn rounded(value: f64) -> Bounded {
    Bounded { error: UNIT * value.abs(), ..Bounded::exact(value) }
}

/// Numbers without an error.
pub fn exact<const D: usize>(x: [f64; D]) -> [Bounded; D] {
    x.map(Bounded::exact)
}

/// Largest size of the exact value.
pub fn size(x: Bounded) -> f64 {
    x.value.abs() + x.error
}

/// aᵀb.
pub fn dot<R: Real, const D: usize>(a: [R; D], b: [R; D]) -> R {
    let mut sum = a[0] * b[0];
    for i in 1..D {
        sum = sum + a[i] * b[i];
    }
    sum
}
