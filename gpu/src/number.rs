//! The elementary functions of `real::elementary` on numbers of PTX, operation by operation.

use std::f64::consts::{FRAC_2_PI, LN_2, LOG2_E};

use real::{Real, coefficients::*, sinh_cosh};

use crate::ptx::{Number, Word};

const SIGN: u64 = 1 << 63;
const FRACTION: u64 = (1 << 52) - 1;
/// 1.5·2⁵²: the low bits of x + ROUND are those of the integer nearest to x.
const ROUND: f64 = 6_755_399_441_055_744.0;
const SIN_COS_LIMIT: f64 = 1_073_741_824.0;

impl Real for Number {
    const DEPTH: u32 = 0;

    fn constant(x: f64) -> Self {
        x.into()
    }

    fn sin_cos(self) -> (Self, Self) {
        Self::through([self], "sin_cos", sin_cos).into()
    }

    fn exp(self) -> Self {
        Self::through([self], "exp", exp)[0]
    }

    fn ln(self) -> Self {
        Self::through([self], "ln", ln)[0]
    }

    fn sinh(self) -> Self {
        Self::through([self], "sinh_cosh", hyperbolic)[0]
    }

    fn cosh(self) -> Self {
        Self::through([self], "sinh_cosh", hyperbolic)[1]
    }

    fn sqrt(self) -> Self {
        self.root()
    }

    fn sinc(self) -> Self {
        let q = self.sin() / self;
        Self::select(self.is("eq", 0.0), 1.0, q)
    }

    fn select(condition: bool, a: Self, b: Self) -> Self {
        if condition { a } else { b }
    }

    fn where_less(x: Self, y: Self, a: Self, b: Self) -> Self {
        match (x.value(), y.value()) {
            (Some(x), Some(y)) if x < y => a,
            (Some(_), Some(_)) => b,
            _ => Self::select(x.is("lt", y), a, b),
        }
    }
}

/// Sine and cosine.
fn sin_cos([of]: [Number; 1]) -> [Number; 2] {
    let x = Number::select(of.size().is("le", SIN_COS_LIMIT), of, of * 0.0);
    let t = x * FRAC_2_PI + ROUND;
    let k = t - ROUND;
    let a = x - k * HALF_PI_1;
    let w = k * HALF_PI_2;
    let b = a - w;
    let e = w - (a - b);
    let w = k * HALF_PI_3;
    let r = b - w;
    let e = (e + (w - (b - r))) + k * HALF_PI_4;
    let z = r * r;
    let s = r - (e - r * (z * polynomial(&SIN, z)));
    let c = Number::one() - (z * 0.5 - (z * z * polynomial(&COS, z) + r * e));
    turn(t.bits(), s, c)
}

/// Exponential.
fn exp([of]: [Number; 1]) -> [Number; 1] {
    const BIASED: f64 = ROUND + 2046.0;
    let x = Number::select(of.is("gt", 710.0), 710.0, of);
    let x = Number::select(x.is("lt", -746.0), -746.0, x);
    let t = x * LOG2_E + BIASED;
    let half = t.bits() >> 1;
    let rest = t.bits().minus(half);
    let k = t - BIASED;
    let [one, other] = [half, rest].map(|power| (power << 52).number());
    let r = (x - k * LN_2_1) - k * LN_2_2;
    let p = Number::one() + (r + r * r * polynomial(&EXP, r));
    [(p * one) * other]
}

/// Logarithm.
fn ln([of]: [Number; 1]) -> [Number; 1] {
    const TWO_54: f64 = 18_014_398_509_481_984.0;
    let subnormal = of.is("lt", f64::MIN_POSITIVE);
    let scale = Number::select(subnormal, TWO_54, 1.0);
    let shift = Number::select(subnormal, 54.0, 0.0);
    let (e, f) = exponent_fraction(of * scale);
    let e = e - shift;
    let s = f / (f + 2.0);
    let z = s * s;
    let h = f * f * 0.5;
    let tail = h - (s * (h + z * polynomial(&LN, z)) + e * LN_2_2);
    let y = e * LN_2_1 - (tail - f);
    let y = Number::select(of.is("lt", f64::INFINITY), y, of);
    let y = Number::select(of.is("gt", 0.0), y, of * f64::NAN);
    [Number::select(of.is("eq", 0.0), f64::NEG_INFINITY, y)]
}

/// Hyperbolic sine and cosine.
fn hyperbolic([of]: [Number; 1]) -> [Number; 2] {
    sinh_cosh(of, of.abs()).into()
}

/// c₀ + c₁z + …, even and odd powers by Horner's scheme in z².
fn polynomial(c: &[f64], z: Number) -> Number {
    let (w, n) = (z * z, c.len());
    let (mut high, mut low) = (Number::from(c[n - 1]), Number::from(c[n - 2]));
    let mut i = n - 2;
    while i >= 2 {
        i -= 2;
        high = high * w + c[i + 1];
        low = low * w + c[i];
    }
    if i == 1 { (high * w + c[0]) + low * z } else { low + high * z }
}

/// (sine, cosine) of a reduced angle plus quarter turns.
fn turn(quarters: Word, s: Number, c: Number) -> [Number; 2] {
    let even = (quarters & 1).is("eq", 0);
    let (s, c) = (Number::select(even, s, c), Number::select(even, c, s));
    let sin_sign = (quarters << 62) & SIGN;
    let cos_sign = sin_sign ^ (quarters << 63);
    [(s.bits() ^ sin_sign).number(), (c.bits() ^ cos_sign).number()]
}

/// (e, f) with x = 2ᵉ(1 + f) and √½ ≤ 1 + f < √2, for a normal x > 0.
fn exponent_fraction(x: Number) -> (Number, Number) {
    const TWO_52: f64 = 4_503_599_627_370_496.0;
    const BIAS: u64 = 1024;
    let bits = x.bits().minus(SQRT_HALF_BITS).plus(BIAS << 52);
    let e = ((bits >> 52) | TWO_52.to_bits()).number() - (TWO_52 + BIAS as f64);
    let m = (bits & FRACTION).plus(SQRT_HALF_BITS).number();
    (e, m - 1.0)
}

/// The next word of xoshiro256++.
fn next_word(state: &mut [Word; 4]) -> Word {
    let result = state[0].plus(state[3]).rotated(23).plus(state[0]);
    let shifted = state[1] << 17;
    state[2] = state[2] ^ state[0];
    state[3] = state[3] ^ state[1];
    state[1] = state[1] ^ state[2];
    state[0] = state[0] ^ state[3];
    state[2] = state[2] ^ shifted;
    state[3] = state[3].rotated(45);
    result
}

/// Two normals from two words of a stream by Box and Muller, as `noise` draws them.
pub fn normal_pair(state: &mut [Word; 4]) -> [Number; 2] {
    const ONE: u64 = 1.0f64.to_bits();
    let radius_word = next_word(state);
    let angle_word = next_word(state);
    let u = ((radius_word & FRACTION) | ONE).number() - (1.0 - 0.5 * f64::EPSILON);
    let (e, f) = exponent_fraction(u);
    let (l, s) = (e * (-2.0 * LN_2), f / (f + 2.0));
    let z = s * s;
    let square = l + s * (z * polynomial(&MINUS_TWO_LN, z) - 4.0);
    let r = ((angle_word & FRACTION) | (ONE | 1)).number() - 1.5;
    let z = r * r;
    let a = r * polynomial(&HALF_TANGENT_ABOVE, z);
    let b = polynomial(&HALF_TANGENT_BELOW, z);
    let (aa, bb) = (a * a, b * b);
    let (x, y, n) = (bb - aa, (a + a) * b, bb + aa);
    let scale = square.root() / n;
    let sign = angle_word & SIGN;
    [scale * (x.bits() ^ sign).number(), scale * y]
}
