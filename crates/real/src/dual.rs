//! Dual numbers: a value and one directional derivative.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::Real;

/// The dual number value + derivative·ε with ε² = 0, for forward differentiation. A nested
/// `Dual<Dual<f64>>` gives second derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<R = f64> {
    /// The value.
    pub value: R,
    /// The derivative in the direction of the seeds.
    pub derivative: R,
}

impl<R: Real> Dual<R> {
    /// `value + derivative·ε`.
    #[inline(always)]
    pub fn new(value: R, derivative: R) -> Self {
        Self { value, derivative }
    }

    /// The independent variable, with derivative 1.
    #[inline(always)]
    pub fn variable(value: R) -> Self {
        Self::new(value, R::one())
    }

    /// A quantity independent of the variable, with derivative 0.
    #[inline(always)]
    pub fn fixed(value: R) -> Self {
        Self::new(value, R::zero())
    }

    /// The chain rule: `value` = f(x) and `slope` = f′(x).
    #[inline(always)]
    fn chain(self, value: R, slope: R) -> Self {
        Self::new(value, slope * self.derivative)
    }
}

impl<R: Real> Add for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self::new(self.value + b.value, self.derivative + b.derivative)
    }
}

impl<R: Real> Sub for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self::new(self.value - b.value, self.derivative - b.derivative)
    }
}

impl<R: Real> Mul for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        Self::new(self.value * b.value, self.derivative * b.value + self.value * b.derivative)
    }
}

impl<R: Real> Div for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        let quotient = self.value / b.value;
        Self::new(quotient, (self.derivative - quotient * b.derivative) / b.value)
    }
}

impl<R: Real> Neg for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.value, -self.derivative)
    }
}

impl<R: Real> Add<f64> for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: f64) -> Self {
        Self::new(self.value + b, self.derivative)
    }
}

impl<R: Real> Sub<f64> for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: f64) -> Self {
        Self::new(self.value - b, self.derivative)
    }
}

impl<R: Real> Mul<f64> for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: f64) -> Self {
        Self::new(self.value * b, self.derivative * b)
    }
}

impl<R: Real> Div<f64> for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn div(self, b: f64) -> Self {
        Self::new(self.value / b, self.derivative / b)
    }
}

impl<R: Real> Real for Dual<R> {
    #[inline(always)]
    fn constant(x: f64) -> Self {
        Self::fixed(R::constant(x))
    }
    #[inline(always)]
    fn value(self) -> f64 {
        self.value.value()
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.chain(sin, cos), self.chain(cos, -sin))
    }
    #[inline(always)]
    fn exp(self) -> Self {
        let exp = self.value.exp();
        self.chain(exp, exp)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        self.chain(self.value.ln(), self.value.recip())
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, (root + root).recip())
    }
    #[inline(always)]
    fn sinc(self) -> Self {
        let sinc = self.value.sinc();
        self.chain(sinc, sinc_slope(self.value, sinc))
    }
    #[inline(always)]
    fn select(condition: bool, a: Self, b: Self) -> Self {
        Self::new(
            R::select(condition, a.value, b.value),
            R::select(condition, a.derivative, b.derivative),
        )
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
    let small = x.value().abs() < SINC_SLOPE_SERIES;
    let square = x * x;
    // Horner from the highest term; the ratio of successive terms is −x² (n+1)/n / ((2n+2)(2n+3)).
    let mut series = R::one();
    for n in (1..SINC_SLOPE_TERMS).rev() {
        let n = n as f64;
        let ratio = (n + 1.0) / (n * (2.0 * n + 2.0) * (2.0 * n + 3.0));
        series = -(square * ratio * series) + 1.0;
    }
    let near = -(x * series) / 3.0;
    // Where the series is used, the division by 1 avoids 0/0, which would give NaN in derivatives.
    let safe = R::select(small, R::one(), x);
    let far = (x.cos() - sinc) / safe;
    R::select(small, near, far)
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
            let scale = 1.0 + theirs.re.abs() + theirs.eps.abs();
            // A dozen operations, each good to a few ulp.
            assert!(
                (ours.value - theirs.re).abs() < 64.0 * f64::EPSILON * scale,
                "{x}: {ours:?} {theirs:?}"
            );
            assert!(
                (ours.derivative - theirs.eps).abs() < 64.0 * f64::EPSILON * scale,
                "{x}: {ours:?} {theirs:?}"
            );
        }
    }

    #[test]
    fn sinc_slope_has_no_cancellation_and_no_jump() {
        let slope = |x: f64| Dual::variable(x).sinc().derivative;
        assert_eq!(slope(0.0), 0.0);
        assert!((slope(1e-9) + 1e-9 / 3.0).abs() < 1e-24);
        let (below, above) = (slope(1.0 - 1e-15), slope(1.0));
        assert!((below - above).abs() < 2e-15, "{below} {above}");
        // Second derivative at the origin, by nesting: sinc″(0) = −1/3.
        let nested = Dual::variable(Dual::variable(0.0)).sinc();
        assert!((nested.derivative.derivative + 1.0 / 3.0).abs() < 1e-15);
    }
}
