//! Branch-free elementary functions of `f64`.
//!
//! Every function is a fixed sequence of additions, multiplications, divisions, selections and
//! integer operations on the bits. There is no branch, no table, no fused multiply-add and no call
//! into a system library. A loop over the lanes of a block therefore vectorises and gives the same
//! bits on every instruction set, except for sign and payload of a NaN.
//!
//! Errors are in units in the last place (ulp) of the exact result. They are measured at 250 000
//! random arguments each (`python3 crates/real/tools/reference_values.py --measure`).
//! `tests/all/elementary.rs` asserts the bounds, also at hard cases.
//!
//! | function | range | measured error | asserted bound |
//! |---|---|---|---|
//! | [`sin`], [`cos`], [`sin_cos`] | `abs(x) <= 2^20` | 1.02 ulp | 1.1 ulp |
//! | [`half_turn`] | `abs(r) <= 1/2` | 5.2e-16 absolute | 5.5e-16 |
//! | [`exp`] | all `x`, also subnormal results | 0.99 ulp | 1.1 ulp |
//! | [`exp_with_remainder`] | normal results | | 2^-55 of the result |
//! | [`ln`] | all `x > 0`, also subnormal | 0.78 ulp | 1 ulp |
//! | [`split_unit`], [`minus_two_ln`] | normal `u` in `(0, 1)` | 3.9 ulp | 4.2 ulp |
//! | [`sin_cos_absolute`] | `abs(x) <= 2^20` | 1.7e-16 absolute | 2.2e-16 |
//! | [`deficit_versine`] | `x² <= ½` | 1.2e-16, 6.4e-16 absolute | 1.4e-16, 7e-16 |
//!
//! Not for kernels, as they branch; measured against the standard library, which errs, too:
//!
//! | function | range | measured error | asserted bound |
//! |---|---|---|---|
//! | [`exp2`] | all `x` | | `2 + 2 abs(x)` ulp, 0 for integers |
//! | [`log2`], [`log10`] | all `x > 0` | 3 ulp | 3 ulp |
//! | [`powf`] | normal results | | `2 + 2 abs(y) max(1, abs(ln x))` ulp |
//! | [`cbrt`] | all `x` | | `2 + abs(ln x)` ulp |
//! | [`hypot`] | all `x`, `y` | 2 ulp | 2 ulp |
//! | [`tanh`] | all `x` | 1.7e-16 absolute | 2.3e-16 |
//! | [`sinc`] | `abs(x) <= 2^20` | 1.73 ulp | 2 ulp |

use std::f64::consts::{FRAC_2_PI, LN_2, LOG2_E};

use crate::{coefficients::*, functions::inverse_factorials};

pub use crate::powers::{cbrt, exp2, hypot, log2, log10, powf, tanh};

/// The low bits of `x + ROUND` are the integer nearest to `x`, if `|x| < 2^51`.
const ROUND: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52
/// The sign bit.
const SIGN: u64 = 1 << 63;
/// The largest argument that [`sin_cos`] reduces.
const SIN_COS_LIMIT: f64 = 1_073_741_824.0; // 2^30

/// `c[0] + c[1] z + … + c[N-1] z^(N-1)`, even and odd powers by Horner's scheme in `z²`. This makes
/// two short chains of dependent operations instead of a long one.
#[inline(always)]
fn polynomial<const N: usize>(c: [f64; N], z: f64) -> f64 {
    let w = z * z;
    let (mut high, mut low) = (c[N - 1], c[N - 2]);
    let mut i = N - 2;
    while i >= 2 {
        i -= 2;
        high = high * w + c[i + 1];
        low = low * w + c[i];
    }
    if i == 1 {
        // N is odd: `high` has the even powers except the last one.
        (high * w + c[0]) + low * z
    } else {
        low + high * z
    }
}

/// (sine, cosine) of a reduced angle plus `quarters` quarter turns; only two bits of it count.
#[inline(always)]
fn turn(quarters: u64, s: f64, c: f64) -> (f64, f64) {
    let (s, c) = if quarters & 1 == 0 { (s, c) } else { (c, s) };
    let sin_sign = (quarters << 62) & SIGN;
    let cos_sign = sin_sign ^ (quarters << 63);
    (f64::from_bits(s.to_bits() ^ sin_sign), f64::from_bits(c.to_bits() ^ cos_sign))
}

/// `(sin x, cos x)`.
///
/// The argument is reduced to `x = k π/2 + r` with `|r| <= π/4` (Cody and Waite 1980). `π/2` is the
/// sum of four parts. The first three have 33 bits, so for `|k| < 2^20` their products with `k` are
/// exact. A second word holds the rounding errors of the subtractions. Sine and cosine of `r` are
/// minimax polynomials in `r²`. The quadrant `k mod 4` swaps them and sets their signs.
///
/// Error at most 1.02 ulp (measured) for `|x| <= 2^20`, also next to the multiples of `π/2`. For
/// `2^20 < |x| <= 2^30` the result belongs to an argument changed by at most one ulp. For larger
/// finite `x` it is `(±0, 1)`. All values are in `[-1, 1]`. `sin(±0) = ±0`; an infinite `x` or NaN
/// gives NaN.
#[inline(always)]
pub fn sin_cos(x: f64) -> (f64, f64) {
    // x * 0 is NaN for the infinite x and NaN.
    let x = if x.abs() <= SIN_COS_LIMIT { x } else { x * 0.0 };
    let t = x * FRAC_2_PI + ROUND;
    let k = t - ROUND;
    // r - e = x - k π/2. Both differences are error-free sums of two words: either the first
    // operand is the larger one, or both are multiples of a unit in which the result has few
    // digits.
    let a = x - k * HALF_PI_1;
    let w = k * HALF_PI_2;
    let b = a - w;
    let e = w - (a - b);
    let w = k * HALF_PI_3;
    let r = b - w;
    let e = (e + (w - (b - r))) + k * HALF_PI_4;

    let z = r * r;
    let s = r - (e - r * (z * polynomial(SIN, z)));
    let c = 1.0 - (0.5 * z - (z * z * polynomial(COS, z) + r * e));
    turn(t.to_bits(), s, c)
}

/// `(sin x, cos x)` for `|x| <= 2^20` with a bounded absolute error, in three quarters of the
/// operations of [`sin_cos`].
///
/// `π/2` has two parts here and there is no second word for rounding errors. Absolute error at most
/// 1.7e-16 (measured); any other `x` gives NaN.
#[inline(always)]
pub fn sin_cos_absolute(x: f64) -> (f64, f64) {
    let t = x * FRAC_2_PI + ROUND;
    let k = t - ROUND;
    let r = (x - k * HALF_PI_1) - k * HALF_PI_REST;
    let r = if x.abs() <= 1_048_576.0 { r } else { f64::NAN };
    let z = r * r;
    // The order of operations keeps chains of dependent operations short.
    let s = r + (r * z) * polynomial(SIN, z);
    let c = (1.0 - 0.5 * z) + (z * z) * polynomial(COS, z);
    turn(t.to_bits(), s, c)
}

/// `sin x`: the same bits as the first value of [`sin_cos`].
#[inline(always)]
pub fn sin(x: f64) -> f64 {
    sin_cos(x).0
}

/// `cos x`: the same bits as the second value of [`sin_cos`].
#[inline(always)]
pub fn cos(x: f64) -> f64 {
    sin_cos(x).1
}

/// `(x, y, n)` with `cos πr = x / n` and `sin πr = y / n`, for `|r| <= ½`.
///
/// With `t = tan(πr/2) = r A(r²) / B(r²)`, `(x, y, n) = (B² - r² A², 2 r A B, B² + r² A²)`. `A` and
/// `B` have degree 3 and err by `2^-53.67` of the angle. An error of the angle leaves the point on
/// the circle: `x² + y² = n²` up to rounding. Absolute error of the quotients at most 5.2e-16
/// (measured). `n` is in `[1, 1.06)`, and `r = 0` is exact.
#[inline(always)]
pub fn half_turn(r: f64) -> (f64, f64, f64) {
    let z = r * r;
    let a = r * polynomial(HALF_TANGENT_ABOVE, z);
    let b = polynomial(HALF_TANGENT_BELOW, z);
    let (aa, bb) = (a * a, b * b);
    (bb - aa, (a + a) * b, bb + aa)
}

/// The argument of an exponential function, moved into the range where the result is neither zero
/// nor infinite or to just outside of it; the integer `k` next to `x / ln 2`; and two powers of two
/// whose product is `2^k`.
#[inline(always)]
fn powers_of_two(x: f64) -> (f64, f64, f64, f64) {
    // The low bits of t are k + 2 * 1023, the sum of two biased exponents.
    const BIASED: f64 = ROUND + 2046.0;
    // Comparisons with NaN are false, so NaN stays NaN.
    let x = if x > 710.0 { 710.0 } else { x };
    let x = if x < -746.0 { -746.0 } else { x };
    let t = x * LOG2_E + BIASED;
    let half = t.to_bits() >> 1;
    let rest = t.to_bits().wrapping_sub(half);
    (x, t - BIASED, f64::from_bits(half << 52), f64::from_bits(rest << 52))
}

/// `e^x`.
///
/// The argument is reduced to `x = k ln 2 + r` with `|r| <= ln 2 / 2`. `ln 2` has two parts, and
/// `k` times the first part is exact. Then `e^r = 1 + r + r² P(r)`, followed by two multiplications
/// by powers of two. Only the last of them can round, namely to a subnormal result.
///
/// Error at most 0.99 ulp (measured) over the full range, also for subnormal results. Above 709.79
/// the result is infinite, below -745.14 it is 0. `exp(±0) = 1`; NaN gives NaN.
#[inline(always)]
pub fn exp(x: f64) -> f64 {
    let (x, k, one, other) = powers_of_two(x);
    let r = (x - k * LN_2_1) - k * LN_2_2;
    let p = 1.0 + (r + r * r * polynomial(EXP, r));
    (p * one) * other
}

/// 1/(k+2)! for k = 0 … 13. The truncation error is below 2^-66 for `|r| <= ln 2 / 2`.
const EXP_SERIES: [f64; 14] = inverse_factorials(2, 1);

/// `e^x` in double-double: `(p, e)` where `p` is `e^x` rounded with an error below one ulp and
/// `p + e` is `e^x` more accurately.
///
/// The reduction is that of [`exp`]. The rounding errors of its three additions are added to `e`.
/// A Taylor series replaces the minimax polynomial, whose leading coefficients are off by 1e-15.
/// The error of `p + e` is the rounding of `r² P(r)`: below `2^-56 e^x`, and below `2^-53 x²` for
/// small `x`. `tests/all/elementary.rs` asserts twice that through `e^x e^{-x} = 1` and `e^{2x} =
/// (e^x)²`. Where `p` is zero, subnormal or infinite, `e` is zero. NaN gives NaN.
#[inline(always)]
pub fn exp_with_remainder(x: f64) -> (f64, f64) {
    let (x, k, one, other) = powers_of_two(x);
    // Each sum has the larger summand first, so that its rounding error is exactly computable.
    let (a, b) = (x - k * LN_2_1, k * LN_2_2);
    let r = a - b;
    let lost_r = (a - r) - b;
    let q = r * r * polynomial(EXP_SERIES, r);
    let d = r + q;
    let lost_d = q - (d - r);
    let p = 1.0 + d;
    let lost_p = d - (p - 1.0);
    let value = (p * one) * other;
    let remainder = ((lost_p + (lost_d + lost_r * p)) * one) * other;
    let normal = (f64::MIN_POSITIVE..f64::INFINITY).contains(&value);
    (value, if normal { remainder } else { 0.0 })
}

/// `(e, f)` with `x = 2^e (1 + f)` and `√½ <= 1 + f < √2`, for a normal `x > 0`.
#[inline(always)]
fn exponent_fraction(x: f64) -> (f64, f64) {
    const FRACTION: u64 = (1 << 52) - 1;
    const TWO_52: f64 = 4_503_599_627_370_496.0;
    const BIAS: u64 = 1024;
    // The bits of x / √½, with an exponent that is positive for every x.
    let bits = x.to_bits().wrapping_sub(SQRT_HALF_BITS).wrapping_add(BIAS << 52);
    let e = f64::from_bits((bits >> 52) | TWO_52.to_bits()) - (TWO_52 + BIAS as f64);
    let m = f64::from_bits((bits & FRACTION).wrapping_add(SQRT_HALF_BITS));
    (e, m - 1.0)
}

/// `ln x`.
///
/// The argument is reduced to `x = 2^e (1 + f)` with `√½ <= 1 + f < √2`. With `s = f / (2 + f)`,
/// `z = s²` and `h = f²/2`, `ln(1 + f) = f - (h - s (h + z P(z)))`, where `2 s + s z P(z)` is the
/// series of `2 artanh s`. `e ln 2` is added in two parts, the first of them exact.
///
/// Error at most 0.78 ulp (measured) for all `x > 0`, also next to 1 and for subnormal `x`.
/// `ln(±0) = -inf`, `ln(inf) = inf`; a negative `x` and NaN give NaN.
#[inline(always)]
pub fn ln(x: f64) -> f64 {
    const TWO_54: f64 = 18_014_398_509_481_984.0;
    let subnormal = x < f64::MIN_POSITIVE;
    let scale = if subnormal { TWO_54 } else { 1.0 };
    let shift = if subnormal { 54.0 } else { 0.0 };
    let (e, f) = exponent_fraction(x * scale);
    let e = e - shift;
    let s = f / (2.0 + f);
    let z = s * s;
    let h = 0.5 * (f * f);
    let tail = h - (s * (h + z * polynomial(LN, z)) + e * LN_2_2);
    let y = e * LN_2_1 - (tail - f);
    let y = if x < f64::INFINITY { y } else { x };
    let y = if x > 0.0 { y } else { x * f64::NAN };
    if x == 0.0 { f64::NEG_INFINITY } else { y }
}

/// `(l, s)` with `-2 ln u = l - 4 artanh s` and `|s| < 0.172`, for a normal `u` in `(0, 1)`.
///
/// With the reduction of [`ln`], `l = -2 e ln 2` and `s = f / (2 + f)`. The second half is
/// [`minus_two_ln`]; a loop for each is faster than one for both, since no chain of dependent
/// operations then is longer than the processor looks ahead. Normal `u >= 1` are allowed as well.
/// Zero, subnormal, negative, infinite and NaN arguments give meaningless values.
#[inline(always)]
pub fn split_unit(u: f64) -> (f64, f64) {
    let (e, f) = exponent_fraction(u);
    (e * (-2.0 * LN_2), f / (2.0 + f))
}

/// `-2 ln u` from the `(l, s)` of [`split_unit`]: `l + s (-4 + z P(z))` with `z = s²`, where `P` is
/// a minimax polynomial.
#[inline(always)]
pub fn minus_two_ln(l: f64, s: f64) -> f64 {
    let z = s * s;
    l + s * (z * polynomial(MINUS_TWO_LN, z) - 4.0)
}

/// `sin(x) / x`, and 1 for `x = ±0`.
///
/// This is the quotient of [`sin`] and `x`. Nothing cancels, since the sine has a small relative
/// error near 0. Error at most 1.73 ulp (measured) for `|x| <= 2^20`. Beyond that the absolute
/// error is below `2^-30` (see [`sin_cos`]). An infinite `x` or NaN gives NaN.
#[inline(always)]
pub fn sinc(x: f64) -> f64 {
    let q = sin(x) / x;
    if x == 0.0 { 1.0 } else { q }
}

/// `(deficit, versine) = ((1 - sin(x)/x)/x², (1 - cos x)/x²)` for `x² <= ½`.
///
/// The means of `cos(ηx)` and `sin(ηx)` over `0 <= η <= 1` are `1 - x² deficit` and `x versine`.
/// Their derivatives are `x (deficit - versine)` and `1 - x² deficit - versine`.
///
/// Both are polynomials in `x²`, without a division or a reduction. Absolute errors at most 1.2e-16
/// and 6.4e-16 (measured); the means multiply them by `x²` and `x`. For any other `x` the deficit
/// is NaN.
#[inline(always)]
pub fn deficit_versine(x: f64) -> (f64, f64) {
    let z = x * x;
    let deficit = polynomial(DEFICIT, z);
    (if z <= 0.5 { deficit } else { f64::NAN }, polynomial(VERSINE, z))
}

/// `x^n` by repeated squaring; `powi(x, 0) = 1` for every `x`, NaN included.
///
/// With a constant `n` the loop unrolls to multiplications alone, for instance `x² x` for `n = 3`
/// and `(x²)²` for `n = 4`. For `n < 0` the result is the reciprocal of `x^|n|`, hence 0 where
/// `x^|n|` overflows. The products follow the bits of `|n|`, lowest first. To first order the
/// relative error is at most `|n| 2^-53`.
#[inline(always)]
pub fn powi(x: f64, n: i32) -> f64 {
    let mut m = n.unsigned_abs();
    let mut square = x;
    let mut p = 1.0;
    while m != 0 {
        if m & 1 == 1 {
            p *= square;
        }
        square *= square;
        m >>= 1;
    }
    if n < 0 { 1.0 / p } else { p }
}
