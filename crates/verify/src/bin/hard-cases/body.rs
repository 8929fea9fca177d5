//! The rigid body with three noises: rough damping, extreme noise, extreme scales.

use analysis::number;
use noise::{Noise, Truncation, WienerPath};
use real::elementary::{cos, sin};
use systems::{
    Constant, Damping, RigidBody,
    paper::{INERTIA, NOISE_INERTIA, half_cosine, rigid_body_start},
};
use verify::rounding::{law_bound, length};

use crate::{
    Context, Expected, Rows, each,
    paths::{CASIMIR, Experiment, Family, Law, OF_BODY, body},
};

/// From here on explicit schemes must grow: Euler's factor 1 − x is at most −3, Heun's 1 − x + x²/2
/// at least 5, and the noise moves |y| by far less than that in a step.
const EXPLICIT_FAILS: f64 = 4.0;
/// From here on the midpoint rule must damp less than it should by a factor of two: its factor (1 −
/// x/2)/(1 + x/2) tends to −1.
const MIDPOINT_FAILS: f64 = 10.0;
/// A state below the normal numbers has lost its digits.
const NORMAL: f64 = 1e-300;

/// γτ from 0.1 to 10⁴, 16 steps of τ = 1/16: exact damping against rational functions of γτ. A step
/// multiplies |y| by e^(−γτ) on every path.
pub fn stiff_damping(context: &Context) -> Rows {
    let (steps, tau) = (16, 1.0 / 16.0);
    each([0.1, 0.5, 1.0, 2.0, 4.0, 10.0, 100.0, 1e3, 1e4], |x: f64| {
        let exact = if (-x).exp() > NORMAL { (-x).exp() } else { 0.0 };
        let experiment = body(context, Constant::new(x / tau)?, (steps, tau))?;
        experiment.rows(format!("{x}: {}", number(exact)), |scheme, paths, ended| {
            let lengths = paths[0].states[1..].iter().map(|y| length(*y));
            let normal: Vec<f64> = lengths.take_while(|length| *length > NORMAL).collect();
            let factor = match normal.last() {
                Some(last) => last.powf(1.0 / normal.len() as f64),
                // The first step underflows, or there is none.
                None => f64::from(u8::from(ended)),
            };
            let off = if exact == 0.0 { factor } else { (factor / exact - 1.0).abs() };
            let kept = !ended && off <= scheme.rounding * law_bound(steps, x * steps as f64);
            let expected = match scheme.family {
                family if family.keeps_casimirs() => Expected::Guarantee(kept, None),
                Family::Midpoint if x >= MIDPOINT_FAILS => Expected::MoreThan(2.0 * exact),
                Family::Explicit if x >= EXPLICIT_FAILS => Expected::MoreThan(1.0),
                _ => Expected::Anything,
            };
            Ok((factor, expected))
        })
    })
}

/// Constant γ < 0, up to 64 steps of τ = 1/64: |y(t)|² = e^(2|γ|t)|y₀|² overflows in finite time.
/// Long before, a step is large for a body that turns so fast.
pub fn anti_damping(context: &Context) -> Rows {
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

/// γ that jumps, and γ that is infinite at a time but integrable, 64 steps: |y(t)|² =
/// e^(−2∫γ)|y₀|² all the same. With each the schemes that evaluate γ where it is infinite.
pub fn rough_damping(context: &Context) -> Rows {
    let settings = [
        ("jumps inside steps", SquareWave(0.1), None),
        ("jump in every half step", SquareWave(ROUGH_TAU / 3.0), None),
        ("γ(0) = ∞", RootPole(0.0), Some(Family::Explicit)),
        ("γ = ∞ between steps", RootPole(0.5), Some(Family::Explicit)),
        ("γ = ∞ in a middle", RootPole(32.5 * ROUGH_TAU), Some(Family::Midpoint)),
        ("γ = ∞ inside a step", RootPole(0.7), None),
    ];
    let law = Law { to_the_end: SOLVED, ..CASIMIR };
    each(settings, |(name, damping, fails)| {
        let must_exceed = |family| (Some(family) == fails).then_some(f64::INFINITY);
        body(context, damping, (64, ROUGH_TAU))?.law_rows(name, &law, must_exceed)
    })
}

/// The fixed point contracts for sure while ‖ψ′‖ < 1, which for this body and |y| = 1 is about
/// max|kᵢ − kⱼ| < 1 with k = τ/I + ΔW/Î.
const CONTRACTS: f64 = 0.1;

/// Increments past the contraction bound, not truncated, γ = 0: one step of τ = 0.1 from random
/// states with |y| = 1. While the map contracts there is one solution; beyond, there may be
/// several.
pub fn large_noise(context: &Context) -> Rows {
    each([CONTRACTS, 0.3, 1.0, 3.0, 10.0, 100.0], |size| {
        let experiment = body(context, Constant::new(0.0)?, (1, 0.1))?;
        // The same normals at every size.
        let key = experiment.key;
        let noise = move |path, _| Noise::increments(WienerPath::new(key, path).increments(size));
        let experiment = Experiment {
            paths: if context.quick { 40 } else { 400 },
            truncation: Truncation::none(),
            noise: Some(Box::new(noise)),
            start: Some(on_sphere),
            ..experiment
        };
        let to_the_end = if size > CONTRACTS { SOLVABLE.to_the_end } else { SOLVED };
        experiment.law_rows(size, &Law { relative: true, to_the_end, ..CASIMIR }, |_| None)
    })
}

/// A point on the unit sphere, on a spiral.
fn on_sphere(number: u64) -> [f64; 3] {
    let height = 2.0 * ((number as f64 + 0.5) * 0.618_033_988_749_894_8).fract() - 1.0;
    let (angle, radius) = (2.4 * number as f64, (1.0 - height * height).sqrt());
    [radius * cos(angle), radius * sin(angle), height]
}

const SOLVED: &[Family] = &[Family::Conformal, Family::WithoutIteration];
const SOLVABLE: Law = Law { to_the_end: &[Family::WithoutIteration], ..CASIMIR };

/// The largest normals that the generator can give, ±√(106 ln 2) = ±8.57, in all combinations of
/// signs, areas ±ΔW², γ = ½cos 2t, 64 steps; truncated or not. The law holds on every path.
pub fn extreme_normals(context: &Context) -> Rows {
    let truncations = [(", truncated", verify::truncation()), ("", Truncation::none())];
    let taus = [1.0 / 1024.0, 1.0 / 64.0, 1.0 / 4.0].into_iter();
    each(taus.flat_map(|tau| truncations.map(|one| (tau, one))), |(tau, (words, truncation))| {
        // √(106 ln 2) is the radius of Box–Muller at the smallest uniform 2⁻⁵³.
        let largest = (106.0 * std::f64::consts::LN_2 * tau).sqrt();
        let size = largest.min(truncation.bound(tau)?);
        let noise = move |_, n: u64| {
            let sign = |m: u32| if ((n + 1) / 3) >> m & 1 == 1 { -1.0 } else { 1.0 };
            let increments = [0, 1, 2].map(|m| sign(m) * size);
            let [a, b, c] = increments.map(|dw| dw * size);
            Noise { increments, areas: [[0.0, a, b], [-a, 0.0, c], [-b, -c, 0.0]] }
        };
        let experiment = body(context, half_cosine(), (64, tau))?;
        let experiment = Experiment { truncation, noise: Some(Box::new(noise)), ..experiment };
        experiment.law_rows(format!("1/{:.0}{words}", 1.0 / tau), &SOLVABLE, |_| None)
    })
}

/// Steps up to 0.9, where truncation is still defined; several paths, γ = ½cos 2t. The scheme keeps
/// the law for every τ at which its equation has a solution.
pub fn big_steps(context: &Context) -> Rows {
    let paths = if context.quick { 4 } else { 32 };
    each([0.1, 0.3, 0.5, 0.7, 0.9], |tau| {
        let experiment = body(context, half_cosine(), (64, tau))?;
        Experiment { paths, ..experiment }.law_rows(tau, &SOLVABLE, |_| None)
    })
}

/// States from 10⁻¹⁵⁰ to 10¹⁵⁰, γ = ½cos 2t, 64 steps of τ = 1/64, no areas. State and moments of
/// inertia are multiplied by a power of two; the solution scales with them, in floating point bit
/// by bit.
pub fn scales(context: &Context) -> Rows {
    let steps = 64;
    let scaled = |scale: f64| {
        let [body, noise] = [INERTIA, NOISE_INERTIA].map(|inertia| inertia.map(|i| i * scale));
        let system = (RigidBody::three_noises(body, noise)?, half_cosine());
        let start = rigid_body_start().map(|y| y * scale);
        let experiment = Experiment::new(context, system, start, (steps, 1.0 / 64.0))?;
        // The weights 1/Î² of the areas overflow or underflow.
        anyhow::Ok(Experiment { areas: false, ..experiment.with_parts(OF_BODY) })
    };
    let plain = scaled(1.0)?;
    each([-498, -332, -166, 166, 332, 498], |exponent| {
        let scale = 2f64.powi(exponent);
        let decimal = f64::from(exponent) * std::f64::consts::LOG10_2;
        let setting = format!("2^{exponent} ≈ 1e{decimal:+.0}");
        scaled(scale)?.rows(setting, |scheme, paths, ended| {
            let plain = plain.path(scheme, 0)?.states;
            let ends = plain
                .last()
                .into_iter()
                .flatten()
                .zip(paths[0].states.last().into_iter().flatten());
            let difference = ends.map(|(a, b)| (b / scale - a).abs()).fold(0.0, f64::max);
            Ok((difference, Expected::at_most(law_bound(steps, 1.0), difference, ended)))
        })
    })
}
