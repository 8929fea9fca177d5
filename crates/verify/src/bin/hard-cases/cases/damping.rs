//! Damping that is stiff, negative, discontinuous or infinite at a time.

use systems::{Constant, Damping};
use verify::rounding::{law_bound, length};

use crate::{
    Case, Context, Rows, each,
    paths::{CASIMIR, Law, body},
    row::Row,
    schemes::Family,
};

/// γτ from 0.1 to 10⁴: exact damping against rational functions of γτ.
///
/// Rigid body with three noises, constant γ, 16 steps of τ = 1/16.
///
/// A step multiplies |y| by e^(−γτ) on every path.
pub const STIFF: Case = Case {
    id: "stiff-damping",
    quantity: "factor of |y| in a step, geometric mean while |y| is a normal number",
    guarantee: "`sexp` has the factor e^(−x), x = γτ, to rounding, underflow included; so have \
                `sexp-li` and `split`. For large x `midpoint` must hardly damp, `em` and `heun` must grow.",
    varied: "γτ",
    rows: stiff,
};

/// From here on explicit schemes must grow: Euler's factor 1 − x is at most −3, Heun's 1 − x + x²/2
/// at least 5, and the noise moves |y| by far less than that in a step.
const EXPLICIT_FAILS: f64 = 4.0;
/// From here on the midpoint rule must damp less than it should by a factor of two: its factor (1 −
/// x/2)/(1 + x/2) tends to −1.
const MIDPOINT_FAILS: f64 = 10.0;
/// A state below the normal numbers has lost its digits.
const NORMAL: f64 = 1e-300;

fn stiff(context: &Context) -> Rows {
    let (steps, tau) = (16, 1.0 / 16.0);
    each([0.1, 0.5, 1.0, 2.0, 4.0, 10.0, 100.0, 1e3, 1e4], |x: f64| {
        let exact = if (-x).exp() > NORMAL { (-x).exp() } else { 0.0 };
        body(context, Constant::new(x / tau)?, (steps, tau))?.rows(x, |row, scheme, paths| {
            let lengths = paths[0].states[1..].iter().map(|y| length(*y));
            let normal: Vec<f64> = lengths.take_while(|length| *length > NORMAL).collect();
            let factor = match normal.last() {
                Some(last) => last.powf(1.0 / normal.len() as f64),
                // The first step underflows, or there is none.
                None => f64::from(u8::from(row.error.is_some())),
            };
            let off = if exact == 0.0 { factor } else { (factor / exact - 1.0).abs() };
            let to_rounding =
                row.error.is_none() && off <= scheme.rounding * law_bound(steps, x * steps as f64);
            let row = Row { exact: Some(exact), ..row.with_figure(factor) };
            Ok(match scheme.family {
                Family::Conformal | Family::WithoutIteration => row.guaranteed(to_rounding, None),
                Family::Midpoint if x >= MIDPOINT_FAILS => row.must_exceed(2.0 * exact),
                Family::Explicit if x >= EXPLICIT_FAILS => row.must_exceed(1.0),
                _ => row,
            })
        })
    })
}

/// Negative γ: the state grows until it overflows.
///
/// Rigid body with three noises, constant γ < 0, up to 64 steps of τ = 1/64.
///
/// |y(t)|² = e^(2|γ|t)|y₀|² overflows in finite time. Long before, a step is large for a body that
/// turns so fast.
pub const ANTI: Case = Case {
    id: "anti-damping",
    quantity: super::SQUARED_LENGTH,
    guarantee: "`sexp`, `sexp-li` and `split` are on the law to rounding, or end with a typed \
                error. Newton's stopping test keeps the law to 2⁻³⁰ a step only.",
    varied: "γτ",
    rows: anti,
};

fn anti(context: &Context) -> Rows {
    // Newton's method stops when a change is below 2⁻³²|z|. The residual that it leaves is the
    // square of that, times a constant that grows with the curvature of the equation. For a body
    // that turns so fast the constant has no bound, and all that is known is that the residual is
    // no larger than the change: F(z) − F(ẑ) is at most 2|z| times it and F is ½|z|².
    let law = Law { newton_step: 4.0 / (1u64 << 32) as f64, ..CASIMIR };
    let tau = 1.0 / 64.0;
    each([-0.01, -0.1, -1.0, -10.0, -100.0, -1e4], |x| {
        // From −0.1 on a step of the other schemes is off the law by more than this.
        let must_exceed = (x <= -0.1).then_some(1e-6);
        body(context, Constant::new(x / tau)?, (64, tau))?.law_rows(x, &law, |_| must_exceed)
    })
}

/// γ that jumps, and γ that is infinite at a time but integrable.
///
/// Rigid body with three noises, 64 steps of τ = 1/64. γ is 4 and −3 alternately, or ½|t −
/// s|^(−½), infinite at s.
///
/// |y(t)|² = e^(−2∫γ)|y₀|² whenever γ is integrable.
pub const ROUGH: Case = Case {
    id: "rough-damping",
    quantity: super::SQUARED_LENGTH,
    guarantee: "`sexp`, `sexp-li` and `split` read only ∫γ and are on the law to rounding. A scheme that evaluates γ \
                where it is infinite must stop: `em` and `heun` at the ends of a step, \
                `midpoint` in its middle.",
    varied: "γ",
    rows: rough,
};

const ROUGH_TAU: f64 = 1.0 / 64.0;

enum Rough {
    /// γ = 4 on [2kh, (2k+1)h), −3 on [(2k+1)h, (2k+2)h), with the half period h.
    SquareWave(f64),
    /// γ = ½|t − s|^{−½}, with the pole s.
    RootPole(f64),
}

use Rough::{RootPole, SquareWave};

/// γ in half period number `k` of the square wave.
fn level(k: f64) -> f64 {
    if k.rem_euclid(2.0) == 0.0 { 4.0 } else { -3.0 }
}

/// ∫½ρ^{−½}dρ between two distances from the pole, without cancellation.
fn between(near: f64, far: f64) -> f64 {
    if near == far { 0.0 } else { (far - near) / (far.sqrt() + near.sqrt()) }
}

impl Damping for Rough {
    fn rate(&self, t: f64) -> f64 {
        match self {
            SquareWave(half_period) => level((t / half_period).floor()),
            RootPole(pole) => 0.5 / (t - pole).abs().sqrt(),
        }
    }

    fn integral(&self, a: f64, b: f64) -> f64 {
        match self {
            // Half periods are counted by number: a boundary that is rounded belongs to one of
            // them or the other, never to both or none.
            SquareWave(half_period) => {
                let mut k = (a / half_period).floor();
                let (mut from, mut sum) = (a, 0.0);
                while from < b {
                    let to = ((k + 1.0) * half_period).clamp(from, b);
                    sum += level(k) * (to - from);
                    (from, k) = (to, k + 1.0);
                }
                sum
            }
            RootPole(pole) => match (a - pole, b - pole) {
                (a, b) if a >= 0.0 => between(a, b),
                (a, b) if b <= 0.0 => between(-b, -a),
                (a, b) => (-a).sqrt() + b.sqrt(),
            },
        }
    }

    fn describe(&self) -> String {
        "γ that jumps or has a pole".into()
    }
}

/// Names, dampings, and the schemes that evaluate γ where it is infinite.
const SETTINGS: [(&str, Rough, Option<Family>); 6] = [
    ("jumps inside steps", SquareWave(0.1), None),
    ("jump in every half step", SquareWave(ROUGH_TAU / 3.0), None),
    ("γ(0) = ∞", RootPole(0.0), Some(Family::Explicit)),
    ("γ = ∞ between steps", RootPole(0.5), Some(Family::Explicit)),
    ("γ = ∞ in a middle", RootPole(32.5 * ROUGH_TAU), Some(Family::Midpoint)),
    ("γ = ∞ inside a step", RootPole(0.7), None),
];

fn rough(context: &Context) -> Rows {
    let to_the_end = &[Family::Conformal, Family::WithoutIteration];
    let law = Law { to_the_end, ..CASIMIR };
    each(SETTINGS, |(name, damping, fails)| {
        let must_exceed = |family| (Some(family) == fails).then_some(f64::INFINITY);
        body(context, damping, (64, ROUGH_TAU))?.law_rows(name, &law, must_exceed)
    })
}
