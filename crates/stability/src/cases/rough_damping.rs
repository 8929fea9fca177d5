//! γ that jumps, and γ that is infinite at a time but integrable.

use systems::Damping;

use super::{Claim, Context, Measured, Words, body, body_start, defect, grid};
use crate::method::Method;
use crate::path::{Path, truncated_noise};
use crate::results::{Case, Row};
use crate::rounding::law_bound;

/// γ = 4 on [2kh, (2k+1)h), −3 on [(2k+1)h, (2k+2)h).
struct SquareWave {
    half_period: f64,
}

const UP: f64 = 4.0;
const DOWN: f64 = -3.0;

impl Damping for SquareWave {
    fn rate(&self, t: f64) -> f64 {
        if (t / self.half_period).floor().rem_euclid(2.0) == 0.0 { UP } else { DOWN }
    }
    fn integral(&self, a: f64, b: f64) -> f64 {
        // Piece by piece, counted by number: a boundary that is rounded belongs to one piece or the
        // other, never to both or none.
        let mut piece = (a / self.half_period).floor();
        let (mut from, mut sum) = (a, 0.0);
        while from < b {
            let to = ((piece + 1.0) * self.half_period).clamp(from, b);
            sum += if piece.rem_euclid(2.0) == 0.0 { UP } else { DOWN } * (to - from);
            (from, piece) = (to, piece + 1.0);
        }
        sum
    }
    fn describe(&self) -> String {
        format!("γ = 4, −3 in turn, each for {}", self.half_period)
    }
}

/// γ = ½|t − s|^{−½}.
struct RootPole {
    at: f64,
}

impl RootPole {
    /// ∫₀ʳ ½ρ^{−½} dρ between two distances from the pole, without cancellation.
    fn between(near: f64, far: f64) -> f64 {
        if near == far { 0.0 } else { (far - near) / (far.sqrt() + near.sqrt()) }
    }
}

impl Damping for RootPole {
    fn rate(&self, t: f64) -> f64 {
        0.5 / (t - self.at).abs().sqrt()
    }
    fn integral(&self, a: f64, b: f64) -> f64 {
        let (a, b) = (a - self.at, b - self.at);
        if a >= 0.0 {
            Self::between(a, b)
        } else if b <= 0.0 {
            Self::between(-b, -a)
        } else {
            (-a).sqrt() + b.sqrt()
        }
    }
    fn describe(&self) -> String {
        format!("γ = ½|t − {}|^(−½)", self.at)
    }
}

const TAU: f64 = 1.0 / 64.0;
const STEPS: u64 = 64;

struct Setting {
    name: &'static str,
    damping: Box<dyn Damping>,
    /// Where γ is infinite: at the start of a step, at its middle, nowhere.
    fails: fn(Method) -> bool,
}

fn explicit(method: Method) -> bool {
    matches!(method, Method::Heun | Method::EulerMaruyama)
}

fn midpoint(method: Method) -> bool {
    method == Method::Midpoint
}

fn settings() -> Vec<Setting> {
    let wave = |half_period| Box::new(SquareWave { half_period });
    let pole = |at| Box::new(RootPole { at });
    vec![
        Setting { name: "jumps inside steps", damping: wave(0.1), fails: |_| false },
        Setting { name: "jump in every half step", damping: wave(TAU / 3.0), fails: |_| false },
        Setting { name: "γ(0) = ∞", damping: pole(0.0), fails: explicit },
        Setting { name: "γ = ∞ between steps", damping: pole(0.5), fails: explicit },
        Setting { name: "γ = ∞ in a middle", damping: pole(32.5 * TAU), fails: midpoint },
        Setting { name: "γ = ∞ inside a step", damping: pole(0.7), fails: |_| false },
    ]
}

pub(super) fn case(context: &Context) -> Case {
    let rows = grid(&settings(), 3, |setting, method| {
        let system = body();
        let damping = setting.damping.as_ref();
        let path = Path { system: &system, damping, y0: body_start(), tau: TAU, steps: STEPS };
        let (mut worst, mut total) = (0.0f64, 0.0);
        let end = path.run(
            method,
            &mut truncated_noise::<3>(context.key(), 0, TAU),
            &mut |n, step, y, _| {
                total += step.damping_integral().abs();
                worst = worst.max(defect(
                    &system,
                    0,
                    2.0,
                    (path.y0, y),
                    damping.integral(0.0, n as f64 * TAU),
                ));
            },
        );
        let measured = Measured { figure: worst, stop: end.err() };
        let claim = if method.conformal() {
            Claim::AtMost(law_bound(STEPS, total))
        } else if (setting.fails)(method) {
            Claim::Exceeds(f64::INFINITY)
        } else {
            Claim::Nothing
        };
        Row { setting: setting.name.to_owned(), ..claim.row("", None, method.id(), measured) }
    });
    Words {
        title: "Rough damping",
        setup: "Rigid body with three noises, 64 steps of τ = 1/64, truncated increments. γ = 4 and −3 in turn; γ = ½|t − s|^(−½), infinite at s and integrable.",
        mathematics: "The law |y(t)|² = e^(−2∫γ)|y₀|² asks of γ only that it is integrable.",
        quantity: "largest relative distance of |y|² from its law",
        guarantee: "`sexp` in all forms reads γ through its integral alone: on the law to rounding, wherever γ jumps or is infinite. Schemes that evaluate γ where it is \
                    infinite must stop with a typed error: `em` and `heun` at the ends of a step, `midpoint` in its middle.",
        varied: "γ",
    }
    .with(context, rows)
}
