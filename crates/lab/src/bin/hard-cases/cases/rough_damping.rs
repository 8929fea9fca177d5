//! γ that jumps, and γ that is infinite at a time but integrable.

use anyhow::Result;
use systems::Damping;

use super::{Case, Context, Words, body, each};
use crate::paths::{CASIMIR, Law};
use crate::results::Row;
use crate::schemes::Family;

pub const CASE: Case = Case {
    words: Words {
        id: "rough-damping",
        title: "Rough damping",
        setup: "Rigid body with three noises, 64 steps of τ = 1/64, truncated increments. γ is 4 \
                and −3 alternately, or γ = ½|t − s|^(−½), infinite at s and integrable.",
        mathematics: "The law |y(t)|² = e^(−2∫γ)|y₀|² requires of γ only that it is integrable.",
        quantity: "largest relative distance of |y|² from its law",
        guarantee: "`sexp` in all forms reads γ through its integral alone: on the law to rounding, \
                    wherever γ jumps or is infinite. Schemes that evaluate γ where it is infinite \
                    must stop with a typed error: `em` and `heun` at the ends of a step, `midpoint` \
                    in its middle.",
        varied: "γ",
        plot: None,
    },
    rows,
};

const TAU: f64 = 1.0 / 64.0;
const STEPS: u64 = 64;

#[derive(Clone, Copy)]
enum Rough {
    /// γ = 4 on [2kh, (2k+1)h), −3 on [(2k+1)h, (2k+2)h), with the half period h.
    SquareWave(f64),
    /// γ = ½|t − s|^{−½}, with the pole s.
    RootPole(f64),
}

use Rough::{RootPole, SquareWave};

/// γ on piece number `piece` of the square wave.
fn level(piece: f64) -> f64 {
    if piece.rem_euclid(2.0) == 0.0 { 4.0 } else { -3.0 }
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
            // Pieces are counted by number: a boundary that is rounded belongs to one piece or the
            // other, never to both or none.
            SquareWave(half_period) => {
                let mut piece = (a / half_period).floor();
                let (mut from, mut sum) = (a, 0.0);
                while from < b {
                    let to = ((piece + 1.0) * half_period).clamp(from, b);
                    sum += level(piece) * (to - from);
                    (from, piece) = (to, piece + 1.0);
                }
                sum
            }
            RootPole(pole) => {
                let (a, b) = (a - pole, b - pole);
                if a >= 0.0 {
                    between(a, b)
                } else if b <= 0.0 {
                    between(-b, -a)
                } else {
                    (-a).sqrt() + b.sqrt()
                }
            }
        }
    }

    fn describe(&self) -> String {
        "γ that jumps or has a pole".to_owned()
    }
}

/// Names, dampings, and the schemes that evaluate γ where it is infinite.
const SETTINGS: [(&str, Rough, Option<Family>); 6] = [
    ("jumps inside steps", SquareWave(0.1), None),
    ("jump in every half step", SquareWave(TAU / 3.0), None),
    ("γ(0) = ∞", RootPole(0.0), Some(Family::Explicit)),
    ("γ = ∞ between steps", RootPole(0.5), Some(Family::Explicit)),
    ("γ = ∞ in a middle", RootPole(32.5 * TAU), Some(Family::Midpoint)),
    ("γ = ∞ inside a step", RootPole(0.7), None),
];

fn rows(context: &Context) -> Result<Vec<Row>> {
    let law = Law { to_the_end: true, ..CASIMIR };
    each(SETTINGS, |(name, damping, fails)| {
        let must_exceed = |family| (Some(family) == fails).then_some(f64::INFINITY);
        body(context, damping, (STEPS, TAU))?.law_rows(name.to_owned(), &law, must_exceed)
    })
}
