//! Numbers that carry a bound of their rounding error, and the degree of the polynomial that they
//! are values of.

use std::cell::Cell;
use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::{Degree, Real, operator::operators};

/// A value with a bound of its rounding error, by running error analysis (Wilkinson 1986; Higham
/// 2002, section 3.3): |computed − exact| ≤ `error`, to first order in the unit round-off u.
///
/// A formula over `Bounded` bounds its own round-off, component by component, with the
/// cancellations that happen in it; over `Dual<Bounded>` that of its derivatives. So an identity is
/// refuted where its defect exceeds the bound, whatever the sizes of other terms.
///
/// An error need not be small: a variable that is known to ± δ gives a value to ± its error.
///
/// A constant of a formula counts as accurate to 8u: it is the result of a few operations. The
/// value also knows a bound of its degree as a polynomial in the variables.
///
/// ```
/// use real::{Bounded, Degree, Real};
///
/// let x = Bounded::variable(1.0 / 3.0);
/// let identity = (x + 1.0) * (x - 1.0) - (x * x - 1.0);
/// assert!(identity.value.abs() <= identity.error && identity.error < 1e-14);
/// assert_eq!((identity.degree, x.exp().degree), (Degree::of(2), Degree::NONE));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounded {
    /// The value.
    pub value: f64,
    /// A bound of its rounding error.
    pub error: f64,
    /// A bound of the degree as a polynomial in the variables.
    pub degree: Degree,
}

/// The unit round-off.
const U: f64 = 0.5 * f64::EPSILON;
/// Relative error of a constant.
const CONSTANT: f64 = 8.0 * U;
/// Relative error of an elementary function: at most 2 ulp, see [`elementary`](crate::elementary).
const FUNCTION: f64 = 4.0 * U;
/// The spacing of subnormal numbers, to which a result that underflows is rounded.
const UNDERFLOW: f64 = f64::from_bits(1);

thread_local! {
    static PIECES: Cell<bool> = const { Cell::new(false) };
}

impl Bounded {
    /// A variable: exact, of degree 1.
    #[must_use]
    pub fn variable(value: f64) -> Self {
        Self { value, error: 0.0, degree: Degree::VARIABLE }
    }

    /// A number without error.
    #[must_use]
    pub fn exact(value: f64) -> Self {
        Self { value, error: 0.0, degree: Degree::CONSTANT }
    }

    /// |x|.
    #[must_use]
    pub fn abs(self) -> Self {
        Self { value: self.value.abs(), ..self }
    }

    /// Evaluates `formula` and says whether it may be made of pieces: it took a square root or a
    /// logarithm, as √x² = |x| and (x²)^{1/2} do, or has a condition.
    /// Otherwise it is analytic but for poles.
    pub fn piecewise<T>(formula: impl FnOnce() -> T) -> (T, bool) {
        let before = PIECES.replace(false);
        let result = formula();
        let own = PIECES.get();
        // A formula within another one belongs to that one too.
        PIECES.set(before || own);
        (result, own)
    }

    fn rounded(value: f64, error: f64, degree: Degree) -> Self {
        Self { value, error: error + U * value.abs(), degree }
    }

    /// An elementary function with this value and propagated error.
    fn function(self, value: f64, error: f64) -> Self {
        let error = error + FUNCTION * value.abs();
        Self { value, error, degree: self.degree.function() }.underflow()
    }

    /// Sums are exact where they are subnormal; products, quotients and functions are not.
    fn underflow(self) -> Self {
        let subnormal = self.value.abs() < f64::MIN_POSITIVE;
        Self { error: self.error + if subnormal { UNDERFLOW } else { 0.0 }, ..self }
    }

    fn is_zero(self) -> bool {
        self.value == 0.0 && self.error == 0.0
    }

    // Too long to be part of every formula.
    fn product(self, b: Self) -> Self {
        let error = self.value.abs() * b.error + (b.value.abs() + b.error) * self.error;
        let product = Self::rounded(self.value * b.value, error, self.degree * b.degree);
        if self.is_zero() || b.is_zero() { product } else { product.underflow() }
    }

    fn quotient(self, b: Self) -> Self {
        let value = self.value / b.value;
        // Not by a number that may be zero.
        let least = (b.value.abs() - b.error).max(0.0);
        let error = (self.error + value.abs() * b.error) / least;
        let quotient = Self::rounded(value, error, self.degree / b.degree);
        if self.is_zero() { quotient } else { quotient.underflow() }
    }
}

operators! { [] Bounded:
    Add::add(a, b: Self)
        => Self::rounded(a.value + b.value, a.error + b.error, a.degree + b.degree);
    Sub::sub(a, b: Self) => a + -b;
    Mul::mul(a, b: Self) => a.product(b);
    Div::div(a, b: Self) => a.quotient(b);
    Neg::neg(a) => Self { value: -a.value, ..a };
    Add::add(a, b: f64) => a + Self::constant(b);
    Sub::sub(a, b: f64) => a - Self::constant(b);
    Mul::mul(a, b: f64) => a * Self::constant(b);
    Div::div(a, b: f64) => a / Self::constant(b);
}

impl Real for Bounded {
    /// Depth that leaves loops rolled: `Bounded` is never in a hot loop.
    const DEPTH: u32 = 2;
    fn constant(x: f64) -> Self {
        Self { value: x, error: CONSTANT * x.abs(), degree: Degree::CONSTANT }
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = Real::sin_cos(self.value);
        // No slope exceeds one, and no value.
        let error = |value: f64| self.error.min(1.0 + value.abs());
        (self.function(sin, error(sin)), self.function(cos, error(cos)))
    }
    fn exp(self) -> Self {
        let value = Real::exp(self.value);
        // e^x(e^δ − 1) ≤ e^x δ(1 + δ) for δ ≤ 1, and < e^{x+δ} beyond.
        let error = match self.error <= 1.0 {
            true => value * (self.error * (1.0 + self.error)),
            false => Real::exp(self.value + self.error),
        };
        self.function(value, error)
    }
    fn ln(self) -> Self {
        PIECES.set(true);
        let least = (self.value - self.error).max(0.0);
        self.function(Real::ln(self.value), self.error / least)
    }
    fn sqrt(self) -> Self {
        PIECES.set(true);
        let root = self.value.sqrt();
        let least = (self.value - self.error).max(0.0).sqrt();
        let error = if self.error > 0.0 { self.error / (root + least) } else { 0.0 };
        self.function(root, error)
    }
    fn sinc(self) -> Self {
        // |sinc′| < ½.
        self.function(Real::sinc(self.value), 0.5 * self.error)
    }
    fn select(condition: bool, a: Self, b: Self) -> Self {
        if condition { a } else { b }
    }
    fn where_less(x: Self, y: Self, a: Self, b: Self) -> Self {
        PIECES.set(true);
        let degree = Degree::where_less(x.degree, y.degree, a.degree, b.degree);
        let (taken, other) = if x.value < y.value { (a, b) } else { (b, a) };
        // Where the error may hide the other piece, its value is within the error.
        let hides = (x.value - y.value).abs() <= x.error + y.error && x.error + y.error > 0.0;
        let apart = if hides { (taken.value - other.value).abs() + other.error } else { 0.0 };
        Self { degree, error: taken.error.max(apart), ..taken }
    }
    fn one() -> Self {
        Self::exact(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Dual;

    /// (x + 1)ⁿ − Σ (n k) xᵏ = 0, which rounds.
    fn binomial<R: Real>(x: R, n: i32) -> R {
        let (mut sum, mut coefficient) = (R::zero(), 1.0);
        for k in 0..=n {
            sum = sum + x.powi(k) * coefficient;
            coefficient *= f64::from(n - k) / f64::from(k + 1);
        }
        (x + 1.0).powi(n) - sum
    }

    #[test]
    fn round_off_is_bounded_and_a_defect_is_not() {
        for n in 1..200 {
            let x = -3.0 + 0.031 * f64::from(n);
            let zero = binomial(Bounded::variable(x), 7);
            assert!(zero.value.abs() <= zero.error, "{x}: {zero:?}");
            let slope = binomial(Dual::variable(Bounded::variable(x)), 7).derivative();
            assert!(slope.value.abs() <= slope.error, "{x}: {slope:?}");
            assert_eq!((zero.degree, slope.degree), (Degree::of(7), Degree::of(7)));
            // sin² + cos² = 1, e^{ln x} = x, and (1 + 1e-10) of it.
            let y = Bounded::variable(x.abs() + 0.1);
            let circle = y.sin() * y.sin() + y.cos() * y.cos() - 1.0;
            let inverse = y.ln().exp() - y;
            let root = y.sqrt() * y.sqrt() - y;
            let quotient = y / (y * y + 1.0) - (y + y.recip()).recip();
            for zero in [circle, inverse, root, quotient] {
                assert!(zero.value.abs() <= zero.error, "{x}: {zero:?}");
                assert!(zero.error < 1e-13 && zero.degree == Degree::NONE);
            }
            let wrong = y.ln().exp() - y * (1.0 + 1e-12);
            assert!(wrong.value.abs() > wrong.error, "{x}: {wrong:?}");
        }
    }

    #[test]
    fn underflow_is_an_error() {
        let (x, y) = (Bounded::variable(0.3e-120), Bounded::variable(0.7e-110));
        let zero = x * x * y - x * (x * y);
        assert!(zero.value.abs() <= zero.error && zero.error < 1e-300, "{zero:?}");
        let tail = Bounded::variable(-700.0).exp();
        for (a, b) in [(0.3, 0.7), (1.7, 0.9)] {
            let zero = tail * 1e-15 * a * b - tail * 1e-15 * (a * b);
            assert!(zero.value.abs() <= zero.error, "{zero:?}");
        }
        // Zero has no error.
        assert_eq!((Bounded::variable(0.0) * 3.0).error, 0.0);
    }

    #[test]
    fn pieces_are_seen_and_not_hidden_by_a_formula_within_another() {
        let x = Bounded::variable(0.3);
        let nested = |first: fn(Bounded) -> Bounded, second: fn(Bounded) -> Bounded| {
            let (inner, outer) = Bounded::piecewise(|| {
                first(x);
                Bounded::piecewise(|| second(x)).1
            });
            [inner, outer]
        };
        let smooth = |x: Bounded| (x * x + x.exp()).sin() / x;
        assert_eq!(nested(smooth, smooth), [false, false]);
        let pieces: [fn(Bounded) -> Bounded; 3] = [
            |x| Bounded::where_less(Bounded::one(), x, x, -x),
            |x| (x * x).sqrt(),
            |x| (x * x).powf(0.5),
        ];
        for piece in pieces {
            assert_eq!(nested(piece, smooth), [false, true]);
            assert_eq!(nested(smooth, piece), [true, true]);
        }
    }

    #[test]
    fn wide_errors_enclose_all_values() {
        fn functions<R: Real>(x: R) -> [R; 5] {
            let square = x * x;
            let jump = R::where_less(x, R::constant(0.3), square - 2.0, x.exp());
            [(x * 40.0).sin(), (-square * 50.0).exp(), x.cos() * (x * 3.0).exp(), jump, x.sinc()]
        }
        for k in 0..400 {
            let (middle, half) = (-2.0 + 0.01 * f64::from(k), 1.7 / f64::from(1 + k % 37));
            let bounds = functions(Bounded { error: half, ..Bounded::variable(middle) });
            for n in -20..=20 {
                let values = functions(middle + half * f64::from(n) / 20.0);
                for (i, (bound, value)) in bounds.iter().zip(values).enumerate() {
                    assert!((value - bound.value).abs() <= bound.error, "{i} {middle} {half}");
                }
            }
            assert!(bounds[0].error <= 2.1);
        }
    }

    #[test]
    fn a_number_that_may_be_zero_has_no_bounded_inverse() {
        let x = Bounded::variable(0.1) * 3.0 - 0.3;
        assert!(x.value.abs() <= x.error);
        assert!(!(Bounded::one() / x).error.is_finite());
    }
}
