//! The degree of a formula as a polynomial.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::{
    Real,
    operator::{functions, operators},
};

/// A bound of the degree of a polynomial, found by evaluating its formula: sums take the larger
/// degree, products add them.
///
/// Nothing depends on a value, so that the compiler knows the degree of an inlined formula, and a
/// question about it costs nothing.
///
/// ```
/// use real::{Degree, Real};
///
/// fn energy<R: Real>(p: R, q: R) -> R {
///     p * p * 0.5 - q.cos()
/// }
/// let [variable, constant] = [Degree::VARIABLE, Degree::CONSTANT];
/// assert_eq!(energy(variable, constant), Degree::of(2));
/// assert_eq!(energy(constant, variable), Degree::NONE);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Degree(u32);

impl Degree {
    /// Degree of a constant.
    pub const CONSTANT: Self = Self(0);
    /// Degree of a variable.
    pub const VARIABLE: Self = Self(1);
    /// Marks a formula that is not shown to be a polynomial.
    pub const NONE: Self = Self(u32::MAX);

    /// The degree n.
    #[must_use]
    pub const fn of(n: u32) -> Self {
        Self(n)
    }

    /// The degree, if a polynomial is shown.
    #[must_use]
    pub fn get(self) -> Option<u32> {
        (self != Self::NONE).then_some(self.0)
    }

    /// Degree of a function of something with this degree.
    #[inline(always)]
    #[must_use]
    pub fn function(self) -> Self {
        if self.0 == 0 { self } else { Self::NONE }
    }

    #[inline(always)]
    fn larger(self, b: Self) -> Self {
        if self.0 > b.0 { self } else { b }
    }
}

operators! { [] Degree:
    Add::add(a, b: Self) => a.larger(b);
    Sub::sub(a, b: Self) => a.larger(b);
    Mul::mul(a, b: Self) => Self(a.0.saturating_add(b.0));
    Div::div(a, b: Self) => if b.0 == 0 { a } else { Self::NONE };
    Neg::neg(a) => a;
    Add::add(a, _b: f64) => a;
    Sub::sub(a, _b: f64) => a;
    Mul::mul(a, _b: f64) => a;
    Div::div(a, _b: f64) => a;
}

impl Real for Degree {
    const DEPTH: u32 = 0;
    functions! {
        constant(_x: f64) => Self::CONSTANT;
        exp(a) => a.function();
        ln(a) => a.function();
        sqrt(a) => a.function();
        sinc(a) => a.function();
        select(_condition: bool, a: Self, b: Self) => a.larger(b);
        // None if the condition varies, since pieces are not a polynomial.
        where_less(x: Self, y: Self, a: Self, b: Self) => {
            if x.larger(y).0 == 0 { a.larger(b) } else { Self::NONE }
        };
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        (self.function(), self.function())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_operation_has_its_degree() {
        let (x, one) = (Degree::VARIABLE, Degree::CONSTANT);
        let square = x * x + one - x * 2.0 + 1.0;
        assert_eq!((square, -square / 3.0 - 1.0, square / one), (Degree(2), Degree(2), Degree(2)));
        assert_eq!((square * square, x.powi(7)), (Degree(4), Degree(7)));
        assert_eq!((one.exp(), one.ln(), one.sqrt(), one.sinc()), (one, one, one, one));
        for none in [x.sin(), x.cos(), x.exp(), x.ln(), x.sqrt(), x.sinc(), one / x, x.recip()] {
            assert_eq!(none, Degree::NONE);
            assert_eq!((none * x, none + x, none * 0.0), (none, none, none));
        }
        assert_eq!(Degree::where_less(x, one, x, -x), Degree::NONE);
        assert_eq!(Degree::where_less(one, one * 2.0, x, one), x);
    }
}
