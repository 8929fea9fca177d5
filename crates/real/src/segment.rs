//! Means along a segment in closed form.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::{
    Real,
    operator::{functions, operators},
};

/// A function of y on the segment y = (a+b)/2 + s(b − a)/2, |s| ≤ 1, with its mean over it where
/// that has a closed form: polynomials of degree two, and sines and cosines of affine functions.
///
/// The form follows from the formula alone, so that the compiler knows it of an inlined one, as of
/// a [`Degree`](crate::Degree).
///
/// ```
/// use real::{Real, Segment};
///
/// fn slope<R: Real>(q: R) -> R {
///     (q * 2.0).sin() + q * 0.5
/// }
/// let mean = slope(Segment::new(0.2, 0.8)).mean().expect("a sine and a multiple");
/// let integral = (0.4f64.cos() - 1.6f64.cos()) / 2.0 / 0.6 + 0.25;
/// assert!((mean - integral).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Segment<R = f64> {
    /// Value at s = 0.
    middle: R,
    /// Half of the difference of both ends of an affine function.
    half: R,
    mean: R,
    form: Form,
}

/// The form of a function; each is one of the next, too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Form {
    Constant,
    Affine,
    /// A function of known mean.
    Known,
    Other,
}

impl<R: Real> Segment<R> {
    /// The component of y that goes from a to b.
    #[inline(always)]
    pub fn new(a: R, b: R) -> Self {
        let middle = (a + b) * 0.5;
        Self { middle, half: (b - a) * 0.5, mean: middle, form: Form::Affine }
    }

    /// The mean, if it has a closed form.
    #[inline(always)]
    pub fn mean(self) -> Option<R> {
        if self.form == Form::Other { None } else { Some(self.mean) }
    }

    /// A function of known mean, if this is `affine` or constant.
    #[inline(always)]
    fn known(affine: Self, middle: R, mean: R) -> Self {
        let form = match affine.form {
            Form::Constant => Form::Constant,
            Form::Affine => Form::Known,
            Form::Known | Form::Other => Form::Other,
        };
        Self::of(middle, mean, form)
    }

    /// A function without a closed form, unless this is constant.
    #[inline(always)]
    fn other(self, value: R) -> Self {
        let form = if self.form == Form::Constant { Form::Constant } else { Form::Other };
        Self::of(value, value, form)
    }

    #[inline(always)]
    fn of(middle: R, mean: R, form: Form) -> Self {
        Self { middle, half: R::zero(), mean, form }
    }

    #[inline(always)]
    fn times(self, factor: R) -> Self {
        let [middle, half, mean] = [self.middle, self.half, self.mean].map(|x| x * factor);
        Self { middle, half, mean, ..self }
    }

    #[inline(always)]
    fn larger(self, b: Self) -> Form {
        if self.form > b.form { self.form } else { b.form }
    }
}

operators! { [R: Real] Segment<R>:
    Add::add(a, b: Self) => {
        let [middle, half] = [a.middle + b.middle, a.half + b.half];
        Self { middle, half, mean: a.mean + b.mean, form: a.larger(b) }
    };
    Sub::sub(a, b: Self) => a + -b;
    Mul::mul(a, b: Self) => if a.form == Form::Constant {
        b.times(a.middle)
    } else if b.form == Form::Constant {
        a.times(b.middle)
    } else {
        let middle = a.middle * b.middle;
        let mean = middle + a.half * b.half * (1.0 / 3.0);
        let form = if a.larger(b) == Form::Affine { Form::Known } else { Form::Other };
        Self::of(middle, mean, form)
    };
    Div::div(a, b: Self) => if b.form == Form::Constant {
        a.times(b.middle.recip())
    } else {
        b.other(a.middle / b.middle)
    };
    Neg::neg(a) => a.times(-R::one());
    Add::add(a, b: f64) => a + Self::constant(b);
    Sub::sub(a, b: f64) => a + Self::constant(-b);
    Mul::mul(a, b: f64) => a.times(R::constant(b));
    Div::div(a, b: f64) => a.times(R::constant(1.0 / b));
}

impl<R: Real> Real for Segment<R> {
    const DEPTH: u32 = R::DEPTH;
    functions! {
        constant(x: f64) => {
            let x = R::constant(x);
            Self::of(x, x, Form::Constant)
        };
        exp(a) => a.other(a.middle.exp());
        ln(a) => a.other(a.middle.ln());
        sqrt(a) => a.other(a.middle.sqrt());
        sinc(a) => a.other(a.middle.sinc());
        select(condition: bool, a: Self, b: Self) => if condition { a } else { b };
        where_less(x: Self, y: Self, a: Self, b: Self) => {
            let form = if x.larger(y) == Form::Constant { a.larger(b) } else { Form::Other };
            let of = |a: R, b: R| R::where_less(x.middle, y.middle, a, b);
            let (middle, half) = (of(a.middle, b.middle), of(a.half, b.half));
            Self { middle, half, mean: of(a.mean, b.mean), form }
        };
    }
    /// The means of sine and cosine are their values at the middle times sinc of the half angle.
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let ((sin, cos), factor) = (self.middle.sin_cos(), self.half.sinc());
        (Self::known(self, sin, sin * factor), Self::known(self, cos, cos * factor))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against Gauss–Legendre quadrature with five nodes, exact to 10⁻¹² here.
    #[test]
    fn means_are_integrals() {
        const NODES: [(f64, f64); 3] = [
            (0.0, 128.0 / 225.0),
            (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
            (0.906_179_845_938_664, 0.236_926_885_056_189_1),
        ];
        fn functions<R: Real>(x: R, y: R) -> [R; 7] {
            let [sum, one] = [x + y * 2.0, R::one()];
            [
                sum / 3.0 - 1.0,
                x * y - x * x * 0.5,
                (x - 0.25).sin() * 3.0,
                -(y * 0.5 + 1.0).cos() / (one * 4.0),
                x.sin() + x * x,
                one.exp() * x,
                R::where_less(one, one * 2.0, x, y),
            ]
        }
        let (x, y) = ([0.3, 0.7], [1.1, 0.8]);
        let found = functions(Segment::new(x[0], x[1]), Segment::new(y[0], y[1]));
        for (k, found) in found.into_iter().enumerate() {
            let mean: f64 = NODES
                .iter()
                .flat_map(|&(s, w)| [(s, w), (-s, if s == 0.0 { 0.0 } else { w })])
                .map(|(s, w)| {
                    let at = |[a, b]: [f64; 2]| 0.5 * (a + b) + 0.5 * s * (b - a);
                    0.5 * w * functions(at(x), at(y))[k]
                })
                .sum();
            assert!((found.mean().unwrap() - mean).abs() < 1e-12, "{k}: {found:?} {mean}");
        }
        let [x, y] = [Segment::new(0.3, 0.7), Segment::new(1.1, 0.8)];
        let one = Segment::one();
        let none = [
            x * x * y,
            x.sin() * y,
            x.sin() * x.cos(),
            (x * x).sin(),
            x.exp(),
            x.ln(),
            x.sqrt(),
            one / x,
            x.sinc(),
            Segment::where_less(x, one, x, y),
        ];
        assert!(none.iter().all(|none| none.mean().is_none()), "{none:?}");
    }
}
