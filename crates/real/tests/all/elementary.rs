//! The elementary functions against 60-digit reference values, against the standard library in
//! dense sweeps, at their special values, and bit for bit across instruction sets.

use real::elementary::{
    cbrt, cos, deficit_versine, exp, exp_with_remainder, exp2, half_turn, hypot, ln, log2, log10,
    minus_two_ln, powf, powi, sin, sin_cos, sin_cos_absolute, sinc, split_unit, tanh,
};

/// Printed by `python3 crates/real/tools/reference_values.py`.
const REFERENCE: &str = include_str!("../elementary_reference.txt");

/// A name, the function and the bound of its error.
type Bound = (&'static str, fn(f64) -> f64, f64);

/// Asserted bounds, as documented in the module: in units of the last place, or absolute below 0.1.
const BOUNDS: [Bound; 12] = [
    ("sin", sin, 1.1),
    ("cos", cos, 1.1),
    ("sinc", sinc, 2.0),
    ("sin_half_turn", |r| half_turn(r).1 / half_turn(r).2, 4.5e-16),
    ("cos_half_turn", |r| half_turn(r).0 / half_turn(r).2, 5.5e-16),
    ("exp", exp, 1.1),
    ("ln", ln, 1.0),
    ("ln_unit", ln_unit, 4.2),
    ("sin_absolute", |x| sin_cos_absolute(x).0, 2.2e-16),
    ("cos_absolute", |x| sin_cos_absolute(x).1, 2.2e-16),
    ("deficit", |x| deficit_versine(x).0, 1.4e-16),
    ("versine", |x| deficit_versine(x).1, 7e-16),
];

/// ln u by its two halves.
#[inline(always)]
fn ln_unit(u: f64) -> f64 {
    let (l, s) = split_unit(u);
    -0.5 * minus_two_ln(l, s)
}

/// The unit in the last place of `y`.
fn ulp(y: f64) -> f64 {
    let y = y.abs();
    (f64::from_bits(y.to_bits() & (0x7ff << 52)) * f64::EPSILON).max(f64::from_bits(1))
}

/// `(ours - exact) / ulp(exact)` for the nearest `value` to an exact one.
fn error_in_ulp(ours: f64, value: f64, remainder: f64) -> f64 {
    if ours == value {
        return remainder.abs();
    }
    // Scaled by a power of two, so that a subnormal unit divides exactly.
    let scale = if value.abs() < 1e-200 { 2f64.powi(600) } else { 1.0 };
    ((ours * scale - value * scale) / (ulp(value) * scale) - remainder).abs()
}

/// A small generator of equidistributed bits.
struct Bits(u64);

impl Bits {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    /// Uniform in `(0, 1)`.
    fn unit(&mut self) -> f64 {
        ((self.next() >> 12) as f64 + 0.5) * 2f64.powi(-52)
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

#[test]
fn reference_values() {
    for (name, function, bound) in BOUNDS {
        let absolute = bound < 0.1;
        let (mut worst, mut at, mut count) = (0.0, 0.0, 0);
        for line in REFERENCE.lines() {
            let mut fields = line.split(' ');
            if fields.next() != Some(name) {
                continue;
            }
            let mut bits =
                || f64::from_bits(u64::from_str_radix(fields.next().unwrap(), 16).unwrap());
            let (x, value) = (bits(), bits());
            let remainder: f64 = fields.next().unwrap().parse().unwrap();
            let mut error = error_in_ulp(function(x), value, remainder);
            if absolute {
                error *= ulp(value);
            }
            assert!(!error.is_nan(), "{name}({x:e})");
            if error > worst {
                (worst, at) = (error, x);
            }
            count += 1;
        }
        let least = if absolute { 70 } else { 280 };
        assert!(count >= least, "{name}: only {count} values");
        assert!(worst <= bound, "{name}({at:e}) is off by {worst:.3e}");
    }
}

/// The worst distance from `theirs`, in ulp, which is below ours + 1 (theirs rounds within one).
fn sweep(
    name: &str,
    ours: impl Fn(f64) -> f64,
    theirs: impl Fn(f64) -> f64,
    bound: f64,
    mut point: impl FnMut(&mut Bits) -> f64,
) {
    let mut bits = Bits(0x9e37_79b9_7f4a_7c15);
    let (mut worst, mut at) = (0.0, 0.0);
    for _ in 0..300_000 {
        let x = point(&mut bits);
        let error = error_in_ulp(ours(x), theirs(x), 0.0);
        assert!(!error.is_nan(), "{name}({x:e})");
        if error > worst {
            (worst, at) = (error, x);
        }
    }
    assert!(worst <= bound + 1.0, "{name}({at:e}) is off by {worst}");
}

#[test]
fn dense_sweeps() {
    let limit = 2f64.powi(20);
    for reach in [7.0, limit] {
        sweep("sin", sin, f64::sin, 1.1, |b| b.between(-reach, reach));
        sweep("cos", cos, f64::cos, 1.1, |b| b.between(-reach, reach));
    }
    sweep("sin", sin, f64::sin, 1.1, |b| b.between(-40.0, 0.0).exp());
    sweep("sinc", sinc, |x| x.sin() / x, 2.0, |b| b.between(-50.0, 50.0));
    for (low, high) in [(-746.0, 709.8), (-2.0, 2.0)] {
        sweep("exp", exp, f64::exp, 1.1, |b| b.between(low, high));
    }
    sweep("exp", exp, f64::exp, 1.1, |b| b.between(-40.0, 0.0).exp());
    let positive = |b: &mut Bits| f64::from_bits(b.next() % f64::INFINITY.to_bits()).max(1e-320);
    sweep("ln", ln, f64::ln, 1.0, positive);
    for (low, high) in [(0.3, 3.0), (0.99, 1.01)] {
        sweep("ln", ln, f64::ln, 1.0, |b| b.between(low, high));
    }
    sweep("ln_unit", ln_unit, f64::ln, 4.2, Bits::unit);
    sweep("ln_unit", ln_unit, f64::ln, 4.2, |b| 1.0 - b.between(-36.0, -1.0).exp());
}

/// The standard library rounds within an ulp, so that a difference is below the bound and one.
#[test]
fn powers_and_logarithms_for_results() {
    let positive = |b: &mut Bits| f64::from_bits(b.next() % f64::INFINITY.to_bits());
    let between = |low: f64, high: f64| move |b: &mut Bits| b.between(low, high);
    sweep("exp2", exp2, f64::exp2, 6.0, between(-2.0, 2.0));
    sweep("exp2", exp2, f64::exp2, 2046.0, between(-1020.0, 1020.0));
    for range in [(0.3, 3.0), (0.999, 1.001)] {
        sweep("log2", log2, f64::log2, 3.0, between(range.0, range.1));
        sweep("log10", log10, f64::log10, 3.0, between(range.0, range.1));
    }
    sweep("log2", log2, f64::log2, 3.0, positive);
    sweep("log10", log10, f64::log10, 3.0, positive);
    sweep("cbrt", cbrt, f64::cbrt, 5.0, between(-20.0, 20.0));
    let finite = |x: f64| if x.is_finite() { x } else { 1.0 };
    sweep("cbrt", cbrt, f64::cbrt, 800.0, |b| finite(f64::from_bits(b.next())));
    for shift in [-1e-3, 0.3, 1.0, 300.0, 1e200] {
        let theirs = |x: f64| x.hypot(shift);
        sweep("hypot", |x| hypot(x, shift), theirs, 2.0, |b| b.between(-3.0, 3.0) * shift);
    }
    let mut bits = Bits(13);
    for _ in 0..100_000 {
        let (x, y) = (bits.between(-8.0, 8.0).exp(), bits.between(-20.0, 20.0));
        let bound = 3.0 + 2.0 * y.abs() * x.ln().abs().max(1.0);
        for y in [y, y.round(), y.round() + 0.5] {
            assert!(error_in_ulp(powf(x, y), x.powf(y), 0.0) <= bound, "{x:e}^{y}");
        }
        assert!((tanh(y) - y.tanh()).abs() <= 2.3e-16 + 1.2e-16, "tanh {y}");
    }
    for k in -1022..1024 {
        assert_eq!((exp2(f64::from(k)), log2(2f64.powi(k))), (2f64.powi(k), f64::from(k)));
    }
    for k in -22..=22 {
        assert_eq!(log10(format!("1e{k}").parse().unwrap()), f64::from(k));
    }
    let infinity = f64::INFINITY;
    for (found, expected) in [
        (exp2(infinity), infinity),
        (exp2(-infinity), 0.0),
        (log2(0.0), -infinity),
        (log10(infinity), infinity),
        (powf(0.0, 0.0), 1.0),
        (powf(0.0, 0.3), 0.0),
        (powf(0.0, -0.3), infinity),
        (powf(-2.0, 3.0), -8.0),
        (powf(4.0, -1.5), 0.125),
        (powf(2.0, 1e10), infinity),
        (powf(2.0, -infinity), 0.0),
        (cbrt(-0.0), -0.0),
        (cbrt(-infinity), -infinity),
        (hypot(3.0, -4.0), 5.0),
        (hypot(0.0, -0.0), 0.0),
        (hypot(1.0, -infinity), infinity),
        (hypot(5e-324, 0.0), 5e-324),
        (hypot(f64::MAX, 1.0), f64::MAX),
        (tanh(infinity), 1.0),
        (tanh(-infinity), -1.0),
    ] {
        assert_eq!(found.to_bits(), expected.to_bits(), "{found:e} is not {expected:e}");
    }
    let unknown = [exp2(f64::NAN), log2(-1.0), log10(f64::NAN), powf(-2.0, 0.3), cbrt(f64::NAN)];
    let with_nan = [hypot(f64::NAN, 1.0), hypot(1.0, f64::NAN), tanh(f64::NAN)];
    assert!(unknown.iter().chain(&with_nan).all(|y| y.is_nan()), "{unknown:?} {with_nan:?}");
}

#[test]
fn large_arguments() {
    // The documented degradation: an argument changed by at most one ulp.
    let mut bits = Bits(7);
    for _ in 0..200_000 {
        let x = bits.between(20.0, 30.0).exp2();
        let (s, c) = sin_cos(x);
        let bound = ulp(x) + 1e-15;
        assert!((s - x.sin()).abs() <= bound && (c - x.cos()).abs() <= bound, "{x:e}");
        assert!(s.abs() <= 1.0 && c.abs() <= 1.0, "{x:e}");
    }
    for _ in 0..200_000 {
        let x = f64::from_bits(bits.next());
        let (s, c) = sin_cos(x);
        if x.is_finite() {
            assert!(s.abs() <= 1.0 && c.abs() <= 1.0, "{x:e}: {s} {c}");
            assert!((s * s + c * c - 1.0).abs() < 1e-15, "{x:e}: {s} {c}");
        } else {
            assert!(s.is_nan() && c.is_nan(), "{x:e}");
        }
    }
    for x in [2f64.powi(31), 1e100, f64::MAX] {
        assert_eq!(sin_cos(x), (0.0, 1.0));
        assert_eq!(sin_cos(-x), (0.0, 1.0));
    }
}

#[test]
fn special_values() {
    let (pair, infinity) = (|(a, b): (f64, f64)| [a, b], f64::INFINITY);
    for x in [f64::NAN, -f64::NAN, infinity, -infinity] {
        let pairs = [sin_cos(x), sin_cos_absolute(x)].map(pair);
        let all = [pairs.as_flattened(), &[sin(x), cos(x), sinc(x), deficit_versine(x).0]].concat();
        assert!(all.iter().all(|y| y.is_nan()), "{x}: {all:?}");
    }
    for x in [1.1e6, 1e16, 1e300] {
        assert!(sin_cos_absolute(-x).0.is_nan() && sin_cos_absolute(x).1.is_nan());
    }
    for x in [0.71, 1.0, 1e300] {
        assert!(deficit_versine(-x).0.is_nan() && deficit_versine(x).0.is_nan());
    }
    for x in [-5e-324, -1.0, f64::MIN, -infinity, f64::NAN, -f64::NAN] {
        assert!(ln(x).is_nan() && (x < 0.0 || exp(x).is_nan()));
    }
    for tiny in [0.0, 5e-324, 1e-310, f64::MIN_POSITIVE, 1e-20] {
        for x in [tiny, -tiny] {
            assert_eq!(
                [sin(x), cos(x), sinc(x)].map(f64::to_bits),
                [x, 1.0, 1.0].map(f64::to_bits)
            );
        }
    }
    for (found, expected) in [
        (exp(0.0), 1.0),
        (exp(-0.0), 1.0),
        (exp(infinity), infinity),
        (exp(-infinity), 0.0),
        (exp(f64::MAX), infinity),
        (exp(f64::MIN), 0.0),
        (exp(709.782_712_893_385), infinity),
        (exp(-745.133_219_101_941_2), 0.0),
        (exp(-745.133_219_101_941_1), 5e-324),
        (ln(1.0), 0.0),
        (ln(0.0), -infinity),
        (ln(-0.0), -infinity),
        (ln(infinity), infinity),
    ] {
        assert_eq!(found.to_bits(), expected.to_bits(), "{found:e} is not {expected:e}");
    }
    assert!(exp(709.782_712_893_383_9).is_finite());
}

#[test]
fn unit_circle() {
    let mut bits = Bits(3);
    for _ in 0..300_000 {
        let u = bits.unit();
        let (x, y, n) = half_turn(u - 0.5);
        assert!(((x * x + y * y) / (n * n) - 1.0).abs() < 1e-15, "{u:e}");
        assert!((1.0..1.06).contains(&n), "{u:e}");
    }
    assert_eq!(half_turn(0.0), (1.0, 0.0, 1.0));
}

#[test]
fn integer_powers() {
    let mut bits = Bits(5);
    for _ in 0..20_000 {
        let x = bits.between(-2.0, 2.0);
        for n in -40_i32..=40 {
            let error = error_in_ulp(powi(x, n), x.powi(n), 0.0);
            assert!(error <= 2.0 + f64::from(n.abs()), "{x:e}^{n}: {error}");
        }
        assert_eq!(powi(x, 0), 1.0);
        assert_eq!(powi(x, 1), x);
        assert_eq!(powi(x, 2), x * x);
        assert_eq!(powi(x, 3), x * (x * x));
        assert_eq!(powi(x, 4), (x * x) * (x * x));
        assert_eq!(powi(x, -1), 1.0 / x);
    }
    assert_eq!(powi(f64::NAN, 0), 1.0);
    assert_eq!(powi(0.0, -1), f64::INFINITY);
    assert_eq!(powi(-0.0, -1), f64::NEG_INFINITY);
    assert_eq!(powi(1.0, i32::MIN), 1.0);
    assert_eq!(powi(2.0, i32::MAX), f64::INFINITY);
    assert_eq!(powi(2.0, i32::MIN), 0.0);
    assert_eq!(powi(-1.0, i32::MAX), -1.0);
}

type Block = [f64; 32];
type Functions = [Block; 16];

/// The results of a function, each in a row.
#[inline(always)]
fn fill<const N: usize, const W: usize>(
    rows: &mut [[f64; W]],
    x: &[f64; W],
    f: impl Fn(f64) -> [f64; N],
) {
    for l in 0..W {
        let results = f(x[l]);
        for n in 0..N {
            rows[n][l] = results[n];
        }
    }
}

#[inline(always)]
fn apply_all<const W: usize>(x: &[f64; W], u: &[f64; W], y: &mut [[f64; W]; 16]) {
    fill(&mut y[0..1], x, |x| [sin(x)]);
    fill(&mut y[1..2], x, |x| [cos(x)]);
    fill(&mut y[2..4], x, |x| sin_cos(x).into());
    fill(&mut y[4..5], x, |x| [exp(x)]);
    fill(&mut y[5..6], x, |x| [ln(x)]);
    fill(&mut y[6..7], u, |u| [ln_unit(u)]);
    fill(&mut y[7..8], x, |x| [sinc(x)]);
    fill(&mut y[8..9], x, |x| [powi(x, -5)]);
    fill(&mut y[9..11], x, |x| sin_cos_absolute(x).into());
    fill(&mut y[11..13], u, |u| deficit_versine(u).into());
    fill(&mut y[13..16], u, |u| half_turn(u).into());
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2"))]
fn widest(x: &Block, u: &Block, y: &mut Functions) {
    apply_all(x, u, y);
}

#[multiversion::multiversion(targets("x86_64+avx2"))]
fn middle(x: &Block, u: &Block, y: &mut Functions) {
    apply_all(x, u, y);
}

#[inline(never)]
fn narrow(x: &Block, u: &Block, y: &mut Functions) {
    apply_all(x, u, y);
}

#[test]
fn same_bits_on_every_instruction_set() {
    // The sign and payload of a NaN are not specified.
    let bits = |y: f64| {
        if y.is_nan() { f64::NAN.to_bits() } else { y.to_bits() }
    };
    let mut random = Bits(11);
    for round in 0..3000 {
        let x: Block = std::array::from_fn(|l| match (round + l) % 4 {
            0 => random.between(-10.0, 10.0),
            1 => random.between(-800.0, 800.0),
            2 => random.between(-20.0, 20.0).exp2(),
            _ => f64::from_bits(random.next()),
        });
        let u: Block = std::array::from_fn(|_| random.unit());
        let mut y = [[[0.0; 32]; 16]; 3];
        widest(&x, &u, &mut y[0]);
        middle(&x, &u, &mut y[1]);
        narrow(&x, &u, &mut y[2]);
        for l in 0..32 {
            // A path alone: without any loop that could vectorise.
            let mut alone = [[0.0]; 16];
            apply_all(&std::hint::black_box([x[l]]), &std::hint::black_box([u[l]]), &mut alone);
            for (f, [expected]) in alone.into_iter().enumerate() {
                let same = y.iter().all(|version| bits(version[f][l]) == bits(expected));
                assert!(same, "function {f} of {:e}", x[l]);
            }
        }
    }
}

#[test]
fn the_remainder_of_the_exponential_has_its_missing_digits() {
    let within = |error: f64, x: f64| {
        error.abs() <= f64::min(2f64.powi(-54), 2f64.powi(-50) * x * x + 1e-24)
    };
    for n in 1..20_000 {
        // Small and large arguments of both signs; 2x is exact.
        let x = (if n % 2 == 0 { 1.0 } else { -1.0 })
            * 2f64.powi(n % 18 - 12)
            * (1.0 + f64::from(n) / 20_000.0);
        let ((p, e), (q, f), (s, g)) =
            (exp_with_remainder(x), exp_with_remainder(-x), exp_with_remainder(2.0 * x));
        assert!(
            (p - exp(x)).abs() <= 1.5 * f64::EPSILON * p && e.abs() <= 0.7 * f64::EPSILON * p,
            "{x}"
        );
        // The products in full: their roundings are what is left by a fused multiplication.
        let one = p.mul_add(q, -1.0) + (p * f + q * e);
        assert!(within(one, x), "{x}: e^x e^-x - 1 = {one:e}");
        let square = (s - p * p) - p.mul_add(p, -(p * p)) + (g - 2.0 * p * e);
        assert!(within(square / s, x), "{x}: e^2x - (e^x)^2 = {:e}", square / s);
    }
    assert_eq!(exp_with_remainder(0.0), (1.0, 0.0));
    assert_eq!(exp_with_remainder(800.0), (f64::INFINITY, 0.0));
    assert_eq!(exp_with_remainder(-800.0), (0.0, 0.0));
    assert!(exp_with_remainder(f64::NAN).0.is_nan());
}
