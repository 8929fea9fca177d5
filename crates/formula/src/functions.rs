//! Functions of numbers that `real` does not have, without branches.

use real::{Real, elementary};

/// tan x = sin x/cos x.
#[inline(always)]
pub fn tan(x: f64) -> f64 {
    let (sin, cos) = elementary::sin_cos(x);
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

/// sinh x for |x| ≤ 1.
#[inline(always)]
fn short_sinh(x: f64) -> f64 {
    let square = x * x;
    let mut sum = SINH_SERIES[9];
    let mut k = 9;
    while k > 1 {
        k -= 1;
        sum = sum * square + SINH_SERIES[k];
    }
    x + x * (square * sum)
}

/// sinh x: a series for |x| < 1, else ½(eˣ − e⁻ˣ). Infinite for |x| > 709.78.
#[inline(always)]
pub fn sinh(x: f64) -> f64 {
    let size = x.abs();
    let exp = elementary::exp(size);
    let long = ((exp - 1.0 / exp) * 0.5).copysign(x);
    if size < 1.0 { short_sinh(x) } else { long }
}

/// cosh x = ½(eˣ + e⁻ˣ). Infinite for |x| > 709.78.
#[inline(always)]
pub fn cosh(x: f64) -> f64 {
    let exp = elementary::exp(x.abs());
    (exp + 1.0 / exp) * 0.5
}

/// tanh x = sinh x/cosh x. It is ±1 from |x| = 20 on, where 1 − |tanh x| < 2⁻⁵³.
#[inline(always)]
pub fn tanh(x: f64) -> f64 {
    let size = x.abs();
    let size = if size > 20.0 { 20.0 } else { size };
    let exp = elementary::exp(size);
    let (sinh, cosh) = ((exp - 1.0 / exp) * 0.5, (exp + 1.0 / exp) * 0.5);
    let sinh = if size < 1.0 { short_sinh(size) } else { sinh };
    (sinh / cosh).copysign(x)
}

/// The smaller number; NaN if either is.
#[inline(always)]
pub fn min(a: f64, b: f64) -> f64 {
    let smaller = if a < b { a } else { b };
    if a.is_nan() { a } else { smaller }
}

/// The larger number; NaN if either is.
#[inline(always)]
pub fn max(a: f64, b: f64) -> f64 {
    let larger = if b < a { a } else { b };
    if a.is_nan() { a } else { larger }
}

/// `a` where x < y, else `b`.
#[inline(always)]
pub fn where_less(x: f64, y: f64, a: f64, b: f64) -> f64 {
    f64::where_less(x, y, a, b)
}
