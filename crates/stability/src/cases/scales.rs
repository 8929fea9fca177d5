//! States from 10⁻¹⁵⁰ to 10¹⁵⁰.

use systems::RigidBody;

use super::{
    Claim, Context, INERTIA, Measured, NOISE_INERTIA, Words, body_start, grid, half_cosine, valid,
};
use crate::path::{Path, truncated_noise};
use crate::results::{Case, Row};
use crate::rounding::law_bound;

/// Powers of two next to 10⁻¹⁵⁰ … 10¹⁵⁰.
const EXPONENTS: [i32; 6] = [-498, -332, -166, 166, 332, 498];
const TAU: f64 = 1.0 / 64.0;
const STEPS: u64 = 64;

pub(super) fn case(context: &Context) -> Case {
    let run = |exponent: i32, method| {
        let scale = 2f64.powi(exponent);
        let system = valid(RigidBody::three_noises(
            INERTIA.map(|i| i * scale),
            NOISE_INERTIA.map(|i| i * scale),
        ));
        let damping = half_cosine();
        let path = Path {
            system: &system,
            damping: &damping,
            y0: body_start().map(|y| y * scale),
            tau: TAU,
            steps: STEPS,
        };
        // Areas weigh with 1/Î², which for these bodies has left the numbers: `sexp-levy` is given
        // none.
        let mut drawn = truncated_noise::<3>(context.key(), 0, TAU);
        let mut noise = || crate::method::Noise::increments(drawn().dw);
        path.run(method, &mut noise, &mut |_, _, _, _| ())
            .map(|y| y.map(|component| component / scale))
    };
    let rows = grid(&EXPONENTS, 3, |&exponent, method| {
        let (plain, scaled) = (run(0, method), run(exponent, method));
        let figure = match (&plain, &scaled) {
            (Ok(plain), Ok(scaled)) => {
                (0..3).map(|i| (scaled[i] - plain[i]).abs()).fold(0.0, f64::max)
            }
            _ => f64::NAN,
        };
        let measured = Measured { figure, stop: scaled.err() };
        Row {
            setting: format!(
                "2^{exponent} ≈ 1e{:+.0}",
                f64::from(exponent) * std::f64::consts::LOG10_2
            ),
            ..Claim::AtMost(law_bound(STEPS, 1.0)).row(
                "",
                Some(f64::from(exponent)),
                method.id(),
                measured,
            )
        }
    });
    Words {
        title: "Tiny and huge states",
        setup: "Rigid body with three noises, γ = ½cos 2t, 64 steps of τ = 1/64, truncated increments; state and moments of inertia multiplied by a power of two.",
        mathematics: "With y and I multiplied by the same number the solution is multiplied by it; in floating point, too, bit by bit, where nothing overflows or underflows.",
        quantity: "largest difference, relative to |y₀|, between the scaled solution and that of scale one",
        guarantee: "No scheme and no stopping test depends on the scale: at most a sweep more or less, a difference of rounding; `sexp-levy` without areas, whose weights 1/Î² leave the numbers.",
        varied: "scale",
    }
    .with(context, rows)
}
