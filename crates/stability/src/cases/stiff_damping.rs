//! γτ from 0.1 to 10⁴: exact damping against rational functions of γτ.

use systems::Constant;

use super::{Claim, Context, Measured, Words, body, body_start, grid, length, valid};
use crate::path::{Path, truncated_noise};
use crate::results::{Case, Row};
use crate::rounding::law_bound;

const TAU: f64 = 1.0 / 16.0;
const DAMPING: [f64; 9] = [0.1, 0.5, 1.0, 2.0, 4.0, 10.0, 100.0, 1e3, 1e4];
const STEPS: u64 = 16;
/// Beyond it explicit schemes must grow: Euler's factor 1 − x is below −3, Heun's 1 − x + x²/2
/// above 5, and the noise moves |y| by far less than that in a step.
const EXPLICIT_FAILS: f64 = 4.0;
/// Beyond it the midpoint rule must damp less than it should by a factor of two: its factor (1 −
/// x/2)/(1 + x/2) tends to −1.
const MIDPOINT_FAILS: f64 = 10.0;

pub(super) fn case(context: &Context) -> Case {
    let rows = grid(&DAMPING, 3, |&x, method| {
        let damping = valid(Constant::new(x / TAU));
        let path =
            Path { system: &body(), damping: &damping, y0: body_start(), tau: TAU, steps: STEPS };
        let (mut last, mut taken) = (1.0, 0);
        let end = path.run(
            method,
            &mut truncated_noise::<3>(context.key(), 0, TAU),
            &mut |n, _, y, _| {
                // A state below the normal numbers has lost its digits.
                if taken + 1 == n && length(y) > 1e-300 {
                    (last, taken) = (length(y), n);
                }
            },
        );
        // Where the first step already underflows the factor is zero.
        let factor =
            if taken == 0 && end.is_ok() { 0.0 } else { last.powf(1.0 / taken.max(1) as f64) };
        let exact = if (-x).exp() > 1e-300 { (-x).exp() } else { 0.0 };
        let measured = Measured { figure: factor, stop: end.err() };
        let row = if method.conformal() {
            let off = if exact == 0.0 { factor } else { (factor / exact - 1.0).abs() };
            let claim = Claim::AtMost(law_bound(STEPS, x * STEPS as f64));
            let verdict = claim.row("", None, "", Measured { figure: off, ..measured }).verdict;
            Row { verdict, ..Claim::Nothing.row("", Some(x), method.id(), measured) }
        } else if x >= MIDPOINT_FAILS && method.id() == "midpoint" {
            Claim::Exceeds(2.0 * exact).row("", Some(x), method.id(), measured)
        } else if x >= EXPLICIT_FAILS && method.id() != "midpoint" {
            Claim::Exceeds(1.0).row("", Some(x), method.id(), measured)
        } else {
            Claim::Nothing.row("", Some(x), method.id(), measured)
        };
        Row { setting: format!("{x}"), exact: Some(exact), ..row }
    });
    Words {
        title: "Stiff damping",
        setup: "Rigid body with three noises, constant γ, 16 steps of τ = 1/16, truncated increments.",
        mathematics: "|y(t)| = e^(−γt)|y₀| on every path: a step multiplies |y| by e^(−γτ).",
        quantity: "the factor by which a step multiplies |y|, geometric mean of the steps before |y| leaves the normal numbers",
        guarantee: "`sexp` in all forms: e^(−γτ) to rounding for every γτ, underflow to zero included. `midpoint` has no such factor: (1 − x/2)/(1 + x/2) with \
                    x = γτ tends to −1, and stiff damping does not damp. `em` (1 − x) and `heun` (1 − x + x²/2) must grow for x > 2 and in the end overflow, \
                    which ends the path with a typed error.",
        varied: "γτ",
    }
    .with(context, rows)
}
