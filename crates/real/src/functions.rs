//! Further functions of numbers of any type, without branches.

use crate::Real;

#[inline(always)]
pub fn abs<R: Real>(x: R) -> R {
    // The sum makes −0 to 0.
    R::where_less(x, R::zero(), -x, x + 0.0)
}

#[inline(always)]
pub fn tan<R: Real>(x: R) -> R {
    let (sin, cos) = x.sin_cos();
    sin / cos
}

/// 1/(2k+1)! for k = 0 … 9. The first omitted term is below 2^-65 of sinh x for |x| ≤ 1.
const SINH_SERIES: [f64; 10] = {
    let mut coefficients = [1.0; 10];
    let (mut factorial, mut k) = (1.0, 1);
    while k < 10 {
        factorial *= (2 * k * (2 * k + 1)) as f64;
        coefficients[k] = 1.0 / factorial;
        k += 1;
    }
    coefficients
};

/// sinh and cosh of x with |x| = `size`; or ±`size`, with the sign of x.
#[inline(always)]
fn sinh_cosh<R: Real>(x: R, size: R) -> (R, R) {
    let square = x * x;
    let mut sum = R::constant(SINH_SERIES[9]);
    let mut k = 9;
    while k > 1 {
        k -= 1;
        sum = sum * square + SINH_SERIES[k];
    }
    let short = x + x * (square * sum);
    let (up, down) = (size.exp(), size.exp().recip());
    let long = (up - down) * 0.5;
    let long = R::where_less(x, R::zero(), -long, long);
    (R::where_less(size, R::one(), short, long), (up + down) * 0.5)
}

#[inline(always)]
pub fn sinh<R: Real>(x: R) -> R {
    sinh_cosh(x, abs(x)).0
}

#[inline(always)]
pub fn cosh<R: Real>(x: R) -> R {
    sinh_cosh(x, abs(x)).1
}

#[inline(always)]
pub fn tanh<R: Real>(x: R) -> R {
    let (size, most) = (abs(x), R::constant(20.0));
    let (sinh, cosh) = sinh_cosh(x, R::where_less(most, size, most, size));
    sinh / cosh
}

#[inline(always)]
pub fn min<R: Real>(a: R, b: R) -> R {
    unless_nan(a, R::where_less(a, b, a, b))
}

#[inline(always)]
pub fn max<R: Real>(a: R, b: R) -> R {
    unless_nan(a, R::where_less(b, a, a, b))
}

/// `b`, or `a` if that is NaN.
#[inline(always)]
fn unless_nan<R: Real>(a: R, b: R) -> R {
    let not_below = R::where_less(R::zero(), a, b, a);
    R::where_less(a, R::constant(f64::INFINITY), b, not_below)
}
