//! Steps up to 0.9, where truncation is still defined.

use super::{
    Claim, Context, Measured, Words, body, body_start, defect, grid, half_cosine, residual_share,
};
use crate::path::{Path, truncated_noise};
use crate::results::{Case, Row};
use crate::rounding::law_bound;
use systems::Damping;

const TAUS: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];

pub(super) fn case(context: &Context) -> Case {
    let (steps, paths) = (64, context.many(32, 4));
    let rows = grid(&TAUS, 3, |&tau, method| {
        let (system, damping) = (body(), half_cosine());
        let path = Path { system: &system, damping: &damping, y0: body_start(), tau, steps };
        let (mut worst, mut excess, mut stop, mut stopped) = (0.0f64, 0.0f64, None, 0u64);
        for number in 0..paths {
            let (mut total, mut robust) = (0.0, 0.0);
            let end = path.run(
                method,
                &mut truncated_noise::<3>(context.key(), number, tau),
                &mut |n, step, y, outcome| {
                    total += step.damping_integral().abs();
                    robust += residual_share(outcome, y);
                    let d = defect(
                        &system,
                        0,
                        2.0,
                        (path.y0, y),
                        damping.integral(0.0, n as f64 * tau),
                    );
                    worst = worst.max(d);
                    excess = excess.max(d / (law_bound(steps, total) + robust));
                },
            );
            if let Err(error) = end {
                stop = Some(error);
                stopped += 1;
            }
        }
        let measured = Measured { figure: worst, stop };
        let row = if method.conformal() {
            let verdict = Claim::AtMostOrStops(1.0)
                .row("", None, "", Measured { figure: excess, stop })
                .verdict;
            Row { verdict, ..Claim::Nothing.row("", Some(tau), method.id(), measured) }
        } else {
            Claim::Nothing.row("", Some(tau), method.id(), measured)
        };
        let error =
            row.error.as_ref().map(|error| format!("{stopped} of {paths} paths stop ({error})"));
        Row { setting: format!("{tau}"), error, ..row }
    });
    Words {
        title: "Big steps",
        setup: "Rigid body with three noises, γ = ½cos 2t, 64 steps, increments truncated with k = 4; several paths.",
        mathematics: "The scheme keeps the conformal law for every τ for which its equation has a solution; the theory of its convergence is about small τ only.",
        quantity: "largest relative distance of |y|² from its law over all paths",
        guarantee: "`sexp` in all forms: on the law to rounding at every τ < 1, or a typed error. Nothing is guaranteed of the others.",
        varied: "τ",
    }
    .with(context, rows)
}
