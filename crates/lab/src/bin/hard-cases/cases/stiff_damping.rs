//! γτ from 0.1 to 10⁴: exact damping against rational functions of γτ.

use anyhow::Result;
use systems::Constant;

use super::{Case, Context, Plot, Words, body, each};
use crate::results::Row;
use crate::rounding::{law_bound, length};
use crate::schemes::Family;

pub const CASE: Case = Case {
    words: Words {
        id: "stiff-damping",
        title: "Stiff damping",
        setup: "Rigid body with three noises, constant γ, 16 steps of τ = 1/16, truncated \
                increments.",
        mathematics: "|y(t)| = e^(−γt)|y₀| on every path: a step multiplies |y| by e^(−γτ).",
        quantity: "the factor by which a step multiplies |y|, geometric mean of the steps before \
                   |y| leaves the normal numbers",
        guarantee: "`sexp` in all forms: e^(−γτ) to rounding for every γτ, underflow to zero \
                    included. `midpoint` has no such factor: (1 − x/2)/(1 + x/2) with x = γτ tends \
                    to −1, so stiff damping does not damp. `em` (1 − x) and `heun` (1 − x + x²/2) \
                    must grow for x > 2 and in the end overflow, which ends the path with a typed \
                    error.",
        varied: "γτ",
        plot: Some(Plot { x_title: "damping in a step, γτ", range: (1e-12, 1e12) }),
    },
    rows,
};

const TAU: f64 = 1.0 / 16.0;
const DAMPING: [f64; 9] = [0.1, 0.5, 1.0, 2.0, 4.0, 10.0, 100.0, 1e3, 1e4];
const STEPS: u64 = 16;
/// From here on explicit schemes must grow: Euler's factor 1 − x is at most −3, Heun's 1 − x + x²/2
/// at least 5, and the noise moves |y| by far less than that in a step.
const EXPLICIT_FAILS: f64 = 4.0;
/// From here on the midpoint rule must damp less than it should by a factor of two: its factor (1 −
/// x/2)/(1 + x/2) tends to −1.
const MIDPOINT_FAILS: f64 = 10.0;
/// A state below the normal numbers has lost its digits.
const NORMAL: f64 = 1e-300;

fn rows(context: &Context) -> Result<Vec<Row>> {
    each(DAMPING, |x| {
        let exact = Some((-x).exp()).filter(|factor| *factor > NORMAL).unwrap_or(0.0);
        body(context, Constant::new(x / TAU)?, (STEPS, TAU))?.rows(x, |row, scheme, paths| {
            let lengths = paths[0].states[1..].iter().map(|y| length(*y));
            let normal: Vec<f64> = lengths.take_while(|length| *length > NORMAL).collect();
            let factor = match normal.last() {
                Some(last) => last.powf(1.0 / normal.len() as f64),
                // The first step underflows, or there is none.
                None => f64::from(u8::from(row.error.is_some())),
            };
            let off = if exact == 0.0 { factor } else { (factor / exact - 1.0).abs() };
            let to_rounding = row.error.is_none() && off <= law_bound(STEPS, x * STEPS as f64);
            let row = Row { exact: Some(exact), ..row.with_figure(factor) };
            Ok(match scheme.family {
                Family::Conformal => row.guaranteed(to_rounding, None),
                Family::Midpoint if x >= MIDPOINT_FAILS => row.must_exceed(2.0 * exact),
                Family::Explicit if x >= EXPLICIT_FAILS => row.must_exceed(1.0),
                _ => row,
            })
        })
    })
}
