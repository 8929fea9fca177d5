//! Negative γ: the state grows until it overflows.

use anyhow::Result;
use systems::Constant;

use super::{Case, Context, Words, body, each};
use crate::paths::{CASIMIR, Law};
use crate::results::Row;

pub const CASE: Case = Case {
    words: Words {
        id: "anti-damping",
        title: "Anti-damping",
        setup: "Rigid body with three noises, constant γ < 0, up to 64 steps of τ = 1/64, truncated \
                increments.",
        mathematics: "|y(t)|² = e^(2|γ|t)|y₀|². It overflows after a finite time, and long before \
                      that the step is large for a body that turns so fast.",
        quantity: "largest relative distance of |y|² from its law, over the steps before the path \
                   ends",
        guarantee: "`sexp` in all forms: on the law to rounding in every step that is made; a step \
                    that cannot be made ends the path with a typed error (no solution, overflow, or \
                    a damping factor that is not finite). With Newton's method first the law is \
                    kept to 2⁻³⁰ a step only: its stopping test assumes that the residual is of the \
                    order of the square of the last change, and the curvature of these equations is \
                    not bounded.",
        varied: "γτ",
        plot: None,
    },
    rows,
};

const TAU: f64 = 1.0 / 64.0;
const DAMPING: [f64; 6] = [-0.01, -0.1, -1.0, -10.0, -100.0, -1e4];
const STEPS: u64 = 64;
/// From here on a step of the other schemes is off the law by more than this.
const OTHERS_FAIL: f64 = -0.1;
const OTHERS_OFF: f64 = 1e-6;

/// Newton's method stops when a change is below 2⁻³²|z|. The residual that it leaves is the square
/// of that, times a constant that grows with the curvature of the equation. For a body that turns
/// so fast the constant has no bound, and all that is known is that the residual is no larger than
/// the change: F(z) − F(ẑ) is at most 2|z| times it and F is ½|z|².
const LAW: Law = Law { newton_step: 4.0 / (1u64 << 32) as f64, ..CASIMIR };

fn rows(context: &Context) -> Result<Vec<Row>> {
    each(DAMPING, |x| {
        let must_exceed = (x <= OTHERS_FAIL).then_some(OTHERS_OFF);
        let experiment = body(context, Constant::new(x / TAU)?, (STEPS, TAU))?;
        experiment.law_rows(x, &LAW, |_| must_exceed)
    })
}
