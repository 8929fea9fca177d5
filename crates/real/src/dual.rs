//! Dual numbers: a value and one directional derivative.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::{
    Real,
    operator::{functions, operators},
};

/// The dual number value + derivative·ε with ε² = 0, for forward differentiation. A nested
/// `Dual<Dual<f64>>` gives second derivatives.
pub type Dual<R = f64> = DualNumber<R, Varies>;

/// A [`Dual`] that knows whether it depends on the seeds; if not, nothing is computed with its
/// derivative.
///
/// Once inlined this is known to the compiler, so a gradient takes the operations that one would
/// write by hand: for a sum of D squares, D products.
pub type Partial<R = f64> = DualNumber<R, bool>;

/// A [`Dual`] or [`Partial`] number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DualNumber<R, V> {
    /// The value.
    pub value: R,
    /// The derivative in the direction of the seeds, if the number varies.
    slope: R,
    varies: V,
}

/// Whether a dual number depends on the seeds, so that its derivative need not be zero.
pub trait Variation: Copy + Send + Sync {
    /// Number of levels that the derivative adds to [`Real::DEPTH`].
    const DEPTH: u32;
    /// Variation of a constant.
    const FIXED: Self;
    /// Variation of a variable.
    const VARIES: Self;
    /// Whether the derivative has to be computed with.
    fn varies(self) -> bool;
    /// Variation of a result of two numbers.
    fn or(self, b: Self) -> Self;
}

/// The [`Variation`] of numbers that all count as varying. With a `DEPTH` of two, loops below are
/// not written out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Varies<const DEPTH: u32 = 1>;

impl<const DEPTH: u32> Variation for Varies<DEPTH> {
    const DEPTH: u32 = DEPTH;
    const FIXED: Self = Self;
    const VARIES: Self = Self;
    #[inline(always)]
    fn varies(self) -> bool {
        true
    }
    #[inline(always)]
    fn or(self, _: Self) -> Self {
        self
    }
}

impl Variation for bool {
    const DEPTH: u32 = 1;
    const FIXED: Self = false;
    const VARIES: Self = true;
    #[inline(always)]
    fn varies(self) -> bool {
        self
    }
    #[inline(always)]
    fn or(self, b: Self) -> Self {
        self | b
    }
}

impl<R: Real, V: Variation> DualNumber<R, V> {
    /// `value + derivative·ε`.
    #[inline(always)]
    pub fn new(value: R, derivative: R) -> Self {
        Self { value, slope: derivative, varies: V::VARIES }
    }

    /// The independent variable, with derivative 1.
    #[inline(always)]
    pub fn variable(value: R) -> Self {
        Self::new(value, R::one())
    }

    /// A quantity independent of the variable, with derivative 0.
    #[inline(always)]
    pub fn fixed(value: R) -> Self {
        Self { value, slope: R::zero(), varies: V::FIXED }
    }

    /// The derivative in the direction of the seeds.
    #[inline(always)]
    pub fn derivative(self) -> R {
        R::select(self.varies.varies(), self.slope, R::zero())
    }

    /// `value`, with `slope` if this number varies.
    #[inline(always)]
    fn with(self, value: R, slope: R) -> Self {
        Self { value, slope, varies: self.varies }
    }

    /// The chain rule: `value` = f(x) and `slope` = f′(x).
    #[inline(always)]
    fn chain(self, value: R, slope: R) -> Self {
        self.with(value, slope * self.slope)
    }

    /// `value`, with the slope `both` if `self` and `b` vary, and `mine` or `other` if one does.
    #[inline(always)]
    fn and(self, b: Self, value: R, both: R, mine: R, other: R) -> Self {
        let one = R::select(self.varies.varies(), mine, other);
        let slope = R::select(self.varies.varies() & b.varies.varies(), both, one);
        Self { value, slope, varies: self.varies.or(b.varies) }
    }
}

operators! { [R: Real, V: Variation] DualNumber<R, V>:
    Add::add(a, b: Self) => a.and(b, a.value + b.value, a.slope + b.slope, a.slope, b.slope);
    Sub::sub(a, b: Self) => a.and(b, a.value - b.value, a.slope - b.slope, a.slope, -b.slope);
    Mul::mul(a, b: Self) => {
        let (mine, other) = (a.slope * b.value, a.value * b.slope);
        a.and(b, a.value * b.value, mine + other, mine, other)
    };
    Div::div(a, b: Self) => {
        let quotient = a.value / b.value;
        let other = quotient * b.slope;
        let numerator = a.and(b, quotient, a.slope - other, a.slope, -other);
        Self { slope: numerator.slope / b.value, ..numerator }
    };
    Neg::neg(a) => a.with(-a.value, -a.slope);
    Add::add(a, b: f64) => a.with(a.value + b, a.slope);
    Sub::sub(a, b: f64) => a.with(a.value - b, a.slope);
    Mul::mul(a, b: f64) => a.with(a.value * b, a.slope * b);
    Div::div(a, b: f64) => a.with(a.value / b, a.slope / b);
}

impl<R: Real, V: Variation> Real for DualNumber<R, V> {
    const DEPTH: u32 = R::DEPTH + V::DEPTH;
    functions! {
        constant(x: f64) => Self::fixed(R::constant(x));
        exp(a) => {
            let exp = a.value.exp();
            a.chain(exp, exp)
        };
        ln(a) => a.chain(a.value.ln(), a.value.recip());
        sqrt(a) => {
            let root = a.value.sqrt();
            a.chain(root, (root + root).recip())
        };
        sinc(a) => {
            let sinc = a.value.sinc();
            a.chain(sinc, sinc_slope(a.value, sinc))
        };
        select(condition: bool, a: Self, b: Self) => Self {
            value: R::select(condition, a.value, b.value),
            slope: R::select(condition, a.derivative(), b.derivative()),
            varies: a.varies.or(b.varies),
        };
        where_less(x: Self, y: Self, a: Self, b: Self) => Self {
            value: R::where_less(x.value, y.value, a.value, b.value),
            slope: R::where_less(x.value, y.value, a.derivative(), b.derivative()),
            varies: a.varies.or(b.varies),
        };
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.chain(sin, cos), self.chain(cos, -sin))
    }
}

/// Below this |x| the derivative of sinc is a series of [`SINC_SLOPE_TERMS`] terms. There the
/// cancellation in (cos x − sinc x)/x exceeds the truncation error of the series.
const SINC_SLOPE_SERIES: f64 = 1.0;
/// First omitted term at |x| = 1: 2n x^{2n−1}/(2n+1)! with n = 10, 3.9e-19, below half an ulp of
/// sinc′(1) ≈ 0.3.
const SINC_SLOPE_TERMS: usize = 9;

/// sinc′(x) = (cos x − sinc x)/x = Σ_{n≥1} (−1)ⁿ 2n x^{2n−1}/(2n+1)!.
#[inline(always)]
fn sinc_slope<R: Real>(x: R, sinc: R) -> R {
    let square = x * x;
    let limit = R::constant(SINC_SLOPE_SERIES * SINC_SLOPE_SERIES);
    // Horner from the highest term; the ratio of successive terms is −x² (n+1)/n / ((2n+2)(2n+3)).
    let mut series = R::one();
    for n in (1..SINC_SLOPE_TERMS).rev() {
        let n = n as f64;
        let ratio = (n + 1.0) / (n * (2.0 * n + 2.0) * (2.0 * n + 3.0));
        series = -(square * ratio * series) + 1.0;
    }
    let near = -(x * series) / 3.0;
    // Where the series is used, the division by 1 avoids 0/0, which would give NaN in derivatives.
    let safe = R::where_less(square, limit, R::one(), x);
    let far = (x.cos() - sinc) / safe;
    R::where_less(square, limit, near, far)
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_dual::{Dual64, DualNum};

    /// A formula that uses every function and operation once.
    fn formula<R: Real>(x: R) -> R {
        let trigonometric = x.sin() * x.cos() + x.sinc();
        let logarithmic = (x * x + 1.0).ln() / (x.exp() + 2.0) - (x * x + 0.5).sqrt();
        trigonometric * 3.0 + logarithmic * x.powi(3) - x.powi(-2) / 4.0 + -(x * x).powf(0.3)
    }

    fn oracle(x: Dual64) -> Dual64 {
        let trigonometric = x.sin() * x.cos() + x.sin() / x;
        let logarithmic = (x * x + 1.0).ln() / (x.exp() + 2.0) - (x * x + 0.5).sqrt();
        trigonometric * 3.0 + logarithmic * x.powi(3) - x.powi(-2) / 4.0 + -(x * x).powf(0.3)
    }

    #[test]
    fn derivatives_agree_with_an_independent_implementation() {
        for x in [-3.7, -1.2, -0.4, 0.3, 0.9, 1.1, 2.5, 9.0] {
            let ours = formula(Dual::variable(x));
            let theirs = oracle(Dual64::from(x).derivative());
            // A dozen operations, each good to a few ulp.
            let allowed = 64.0 * f64::EPSILON * (1.0 + theirs.re.abs() + theirs.eps.abs());
            let close = |a: f64, b: f64| (a - b).abs() < allowed;
            let both = close(ours.value, theirs.re) && close(ours.derivative(), theirs.eps);
            assert!(both, "{x}: {ours:?} {theirs:?}");
        }
    }

    #[test]
    fn sinc_slope_has_no_cancellation_and_no_jump() {
        let slope = |x: f64| Dual::variable(x).sinc().derivative();
        assert_eq!(slope(0.0), 0.0);
        assert!((slope(1e-9) + 1e-9 / 3.0).abs() < 1e-24);
        let (below, above) = (slope(1.0 - 1e-15), slope(1.0));
        assert!((below - above).abs() < 2e-15, "{below} {above}");
        // Second derivative at the origin, by nesting: sinc″(0) = −1/3.
        let nested = Dual::variable(Dual::variable(0.0)).sinc();
        assert!((nested.derivative().derivative() + 1.0 / 3.0).abs() < 1e-15);
    }
}
