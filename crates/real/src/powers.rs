//! Powers, other logarithms and lengths, with branches: for results, not for kernels. They call
//! nothing but the functions of [`elementary`](crate::elementary), so their bits are the same on
//! every machine.

use std::f64::consts::{LN_2, LN_10};

use crate::elementary::{exp, ln, powi};

/// `2^x`, exact for an integer `x` with a normal result.
pub fn exp2(x: f64) -> f64 {
    powf(2.0, x)
}

/// `log x` to the base 2, exact for powers of two.
pub fn log2(x: f64) -> f64 {
    to_base(x, 2.0, LN_2)
}

/// `log x` to the base 10, exact for the powers of ten from 1e-22 to 1e22.
pub fn log10(x: f64) -> f64 {
    to_base(x, 10.0, LN_10)
}

/// `ln x / ln base`, or the integer beside it if the power with this exponent is `x`.
fn to_base(x: f64, base: f64, ln_base: f64) -> f64 {
    let y = ln(x) / ln_base;
    let k = y.round();
    if powi(base, k as i32) == x { k } else { y }
}

/// `x^y`: by [`powi`] for an integer `y` with `|y| < 2^31`, times the root if `2y` is odd, else
/// `e^(y ln x)`, which is NaN for `x < 0`.
pub fn powf(x: f64, y: f64) -> f64 {
    let twice = 2.0 * y;
    if twice.fract() != 0.0 || twice.abs() >= 4_294_967_296.0 {
        exp(y * ln(x))
    } else if y.fract() == 0.0 {
        powi(x, y as i32)
    } else {
        let root = x.sqrt();
        powi(x, y as i32) * if y < 0.0 { 1.0 / root } else { root }
    }
}

/// The cube root, `e^(ln|x|/3)` with the sign of `x`.
pub fn cbrt(x: f64) -> f64 {
    exp(ln(x.abs()) / 3.0).copysign(x)
}

/// `√(x² + y²)`, without overflow of the squares. NaN if one of them is NaN.
pub fn hypot(x: f64, y: f64) -> f64 {
    let (x, y) = (x.abs(), y.abs());
    let (large, small) = if x < y { (y, x) } else { (x, y) };
    let ratio = small / large;
    if large == 0.0 || large == f64::INFINITY {
        large + small
    } else {
        large * (1.0 + ratio * ratio).sqrt()
    }
}

/// `tanh x`, with an absolute error of `2^-52`.
pub fn tanh(x: f64) -> f64 {
    1.0 - 2.0 / (exp(2.0 * x) + 1.0)
}
