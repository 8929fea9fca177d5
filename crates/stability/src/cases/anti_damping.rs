//! Negative γ: the state is pumped until it leaves the numbers.

use systems::Constant;

use super::{Claim, Context, Measured, Words, body, body_start, defect, grid, valid};
use crate::method::Method;
use crate::path::{Path, truncated_noise};
use crate::results::{Case, Row};
use crate::rounding::law_bound;

const TAU: f64 = 1.0 / 64.0;
const DAMPING: [f64; 6] = [-0.01, -0.1, -1.0, -10.0, -100.0, -1e4];
const STEPS: u64 = 64;
/// From here on a step of the other schemes is off the law by more than this.
const OTHERS_FAIL: f64 = -0.1;
const OTHERS_OFF: f64 = 1e-6;

/// Newton's method stops when a change is below 2⁻³²|z|. The residual that it leaves is the square
/// of that, times a constant that grows with the curvature of the equation; for a body that turns
/// so fast the constant has no bound, and what is left is that the residual is no larger than the
/// change: F(z) − F(ẑ) is at most 2|z| times it and F is ½|z|².
const NEWTON: f64 = 4.0 / (1u64 << 32) as f64;

pub(super) fn case(context: &Context) -> Case {
    let rows = grid(&DAMPING, 3, |&x, method| {
        let damping = valid(Constant::new(x / TAU));
        let system = body();
        let path =
            Path { system: &system, damping: &damping, y0: body_start(), tau: TAU, steps: STEPS };
        let (mut worst, mut robust) = (0.0f64, 0.0);
        let end = path.run(
            method,
            &mut truncated_noise::<3>(context.key(), 0, TAU),
            &mut |n, _, y, outcome| {
                robust += super::residual_share(outcome, y);
                // The Casimir is a square: above this it overflows before the state does.
                if y.iter().all(|component| component.abs() < 1e150) {
                    worst = worst.max(defect(&system, 0, 2.0, (path.y0, y), x * n as f64));
                }
            },
        );
        let measured = Measured { figure: worst, stop: end.err() };
        let claim = if method.conformal() {
            let newton = if method == Method::SexpNewton { NEWTON * STEPS as f64 } else { 0.0 };
            Claim::AtMostOrStops(law_bound(STEPS, x.abs() * STEPS as f64) + robust + newton)
        } else if x <= OTHERS_FAIL {
            Claim::Exceeds(OTHERS_OFF)
        } else {
            Claim::Nothing
        };
        Row { setting: format!("{x}"), ..claim.row("", Some(x), method.id(), measured) }
    });
    Words {
        title: "Anti-damping",
        setup: "Rigid body with three noises, constant γ < 0, up to 64 steps of τ = 1/64, truncated increments.",
        mathematics: "|y(t)|² = e^(2|γ|t)|y₀|². It leaves the range of floating point after a finite time, and long before that the step is large for a body that turns so fast.",
        quantity: "largest relative distance of |y|² from its law, over the steps before the path ends",
        guarantee: "`sexp` in all forms: on the law to rounding in every step that is made; a step that cannot be made ends the path with a typed error (no \
                    solution, overflow, or a damping factor that is not finite). With Newton's method first the law is kept to 2⁻³⁰ a step only: its stopping test trusts \
                    that the residual is the square of the last change, and the curvature of these equations has no bound.",
        varied: "γτ",
    }
    .with(context, rows)
}
