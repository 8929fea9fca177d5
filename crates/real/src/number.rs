//! The trait of real numbers and its implementation for `f64`.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::{
    elementary,
    functions::{sinh_cosh, unless_nan},
    operator::functions,
};

/// A number type that formulas are written for: arithmetic and elementary functions.
///
/// `f64` implements it, and so does [`Dual`](crate::Dual) over any `Real`. An operation with an
/// `f64` on the right is cheaper than converting the constant to `Self` first. There are no
/// comparisons and no values to look at, because a formula with a branch would not vectorise.
/// [`Real::where_less`] chooses between two values.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a number that formulas are written for",
    note = "write the formula for any `R: Real`; constants stand on the right: `y[0] * 2.0`"
)]
pub trait Real:
    Copy
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// Number of nested derivatives. Loops over components are written out ([`unrolled!`]) for
    /// first derivatives of first derivatives and below.
    ///
    /// [`unrolled!`]: crate::unrolled
    const DEPTH: u32;
    /// The constant `x`, with derivative zero.
    fn constant(x: f64) -> Self;
    /// (sin x, cos x) with one argument reduction.
    fn sin_cos(self) -> (Self, Self);
    /// eˣ.
    fn exp(self) -> Self;
    /// Natural logarithm; NaN for negative values.
    fn ln(self) -> Self;
    /// √x.
    fn sqrt(self) -> Self;
    /// sin(x)/x without cancellation, and 1 at x = 0.
    fn sinc(self) -> Self;
    /// `a` if `condition`, else `b`, without a branch.
    fn select(condition: bool, a: Self, b: Self) -> Self;
    /// `a` where x < y, else `b`, without a branch.
    fn where_less(x: Self, y: Self, a: Self, b: Self) -> Self;

    /// 0.
    #[inline(always)]
    fn zero() -> Self {
        Self::constant(0.0)
    }
    /// 1.
    #[inline(always)]
    fn one() -> Self {
        Self::constant(1.0)
    }
    /// sin x.
    #[inline(always)]
    fn sin(self) -> Self {
        self.sin_cos().0
    }
    /// cos x.
    #[inline(always)]
    fn cos(self) -> Self {
        self.sin_cos().1
    }
    /// 1/x.
    #[inline(always)]
    fn recip(self) -> Self {
        Self::one() / self
    }
    /// xⁿ by repeated squaring. Use a constant n: the loop is then unrolled.
    #[inline(always)]
    fn powi(self, n: i32) -> Self {
        let mut base = if n < 0 { self.recip() } else { self };
        let mut exponent = n.unsigned_abs();
        let mut power = Self::one();
        while exponent > 0 {
            if exponent & 1 == 1 {
                power = power * base;
            }
            exponent >>= 1;
            if exponent > 0 {
                base = base * base;
            }
        }
        power
    }
    /// xᵖ = e^{p ln x} for x > 0.
    #[inline(always)]
    fn powf(self, p: f64) -> Self {
        (self.ln() * p).exp()
    }
    /// tan x = sin x/cos x.
    #[inline(always)]
    fn tan(self) -> Self {
        let (sin, cos) = self.sin_cos();
        sin / cos
    }
    /// sinh x: a series for |x| < 1, else ½(eˣ − e⁻ˣ). Infinite for |x| > 709.78.
    #[inline(always)]
    fn sinh(self) -> Self {
        sinh_cosh(self, self.abs()).0
    }
    /// cosh x = ½(eˣ + e⁻ˣ). Infinite for |x| > 709.78.
    #[inline(always)]
    fn cosh(self) -> Self {
        sinh_cosh(self, self.abs()).1
    }
    /// tanh x = sinh x/cosh x. It is ±1 from |x| = 20 on, where 1 − |tanh x| < 2⁻⁵³.
    #[inline(always)]
    fn tanh(self) -> Self {
        let (size, most) = (self.abs(), Self::constant(20.0));
        let size = Self::where_less(most, size, most, size);
        let (sinh, cosh) = sinh_cosh(self, size);
        sinh / cosh
    }
    /// |x|.
    #[inline(always)]
    fn abs(self) -> Self {
        // The sum makes −0 to 0.
        Self::where_less(self, Self::zero(), -self, self + 0.0)
    }
    /// The smaller number; NaN if either is.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        unless_nan(self, Self::where_less(self, other, self, other))
    }
    /// The larger number; NaN if either is.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        unless_nan(self, Self::where_less(other, self, self, other))
    }
}

impl Real for f64 {
    const DEPTH: u32 = 0;
    functions! {
        constant(x: f64) => x;
        exp(x) => elementary::exp(x);
        ln(x) => elementary::ln(x);
        sqrt(x) => f64::sqrt(x);
        sinc(x) => elementary::sinc(x);
        select(condition: bool, a: Self, b: Self) => if condition { a } else { b };
        where_less(x: Self, y: Self, a: Self, b: Self) => if x < y { a } else { b };
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        elementary::sin_cos(self)
    }
    #[inline(always)]
    fn powi(self, n: i32) -> Self {
        elementary::powi(self, n)
    }
}
