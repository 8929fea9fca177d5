//! The largest normals that the generator can give, in all directions.

use super::{
    Claim, Context, Measured, Words, body, body_start, defect, grid, half_cosine, residual_share,
};
use crate::method::Noise;
use crate::path::Path;
use crate::results::{Case, Row};
use crate::rounding::law_bound;
use noise::Truncation;
use systems::Damping;

const TAUS: [f64; 3] = [1.0 / 1024.0, 1.0 / 64.0, 1.0 / 4.0];
const STEPS: u64 = 64;

/// √(106 ln 2), the radius of Box–Muller at the smallest uniform 2⁻⁵³.
fn largest_normal() -> f64 {
    (106.0 * std::f64::consts::LN_2).sqrt()
}

pub(super) fn case(context: &Context) -> Case {
    let settings: Vec<(f64, bool)> =
        TAUS.iter().flat_map(|&tau| [(tau, true), (tau, false)]).collect();
    let rows = grid(&settings, 3, |&(tau, truncated), method| {
        let (system, damping) = (body(), half_cosine());
        let bound = if truncated {
            Truncation::new(4)
                .ok()
                .and_then(|truncation| truncation.bound(tau).ok())
                .unwrap_or(f64::INFINITY)
        } else {
            f64::INFINITY
        };
        let size = (largest_normal() * tau.sqrt()).min(bound);
        let mut drawn = 0u32;
        let mut noise = || {
            // All eight combinations of signs, each for some steps; areas as large as they come.
            drawn += 1;
            let sign = |m: u32| if (drawn / 3) >> m & 1 == 1 { -1.0 } else { 1.0 };
            let area = |m: u32| sign(m) * size * size;
            Noise {
                dw: [sign(0) * size, sign(1) * size, sign(2) * size],
                areas: [
                    [0.0, area(0), area(1)],
                    [-area(0), 0.0, area(2)],
                    [-area(1), -area(2), 0.0],
                ],
            }
        };
        let path = Path { system: &system, damping: &damping, y0: body_start(), tau, steps: STEPS };
        let (mut worst, mut total, mut robust) = (0.0f64, 0.0, 0.0);
        let end = path.run(method, &mut noise, &mut |n, step, y, outcome| {
            total += step.damping_integral().abs();
            robust += residual_share(outcome, y);
            worst = worst.max(defect(
                &system,
                0,
                2.0,
                (path.y0, y),
                damping.integral(0.0, n as f64 * tau),
            ));
        });
        let measured = Measured { figure: worst, stop: end.err() };
        let claim = if method.conformal() {
            Claim::AtMostOrStops(law_bound(STEPS, total) + robust)
        } else {
            Claim::Nothing
        };
        let setting = format!("1/{:.0}{}", 1.0 / tau, if truncated { ", truncated" } else { "" });
        Row { setting, ..claim.row("", None, method.id(), measured) }
    });
    Words {
        title: "Extreme normals",
        setup: "Rigid body with three noises, γ = ½cos 2t, 64 steps. Every increment is ±√τ·√(106 ln 2) = ±8.57√τ, the largest that the generator can give, in all combinations \
                of signs; areas ±ΔW². With truncation (k = 4) and without.",
        mathematics: "Every increment is a possible one: the law holds on every path.",
        quantity: "largest relative distance of |y|² from its law, over the steps before the path ends",
        guarantee: "`sexp` in all forms: on the law to rounding, or a typed error where the equation has no solution on the branch of the flow.",
        varied: "τ",
    }
    .with(context, rows)
}
