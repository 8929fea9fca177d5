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

/// The bound is a bound: 1 is added to x and subtracted again, which leaves anything up to half an
/// ulp of 1.
#[test]
fn cancellation_is_noticed() {
    let mut largest: f64 = 0.0;
    for k in 1..1000 {
        let x = 1e-3 / f64::from(k);
        let again = (Bounded::exact(x) + Bounded::exact(1.0)) - Bounded::exact(1.0);
        assert!((again.value - x).abs() <= again.error);
        largest = largest.max((again.value - x).abs() / again.error);
    }
    assert!(largest > 0.9, "{largest}");
}
