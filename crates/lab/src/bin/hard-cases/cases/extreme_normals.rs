//! The largest normals that the generator can give, in all directions.

use anyhow::Result;
use noise::{BlockNoise, Truncation};
use real::WIDTH;
use systems::paper::half_cosine;

use super::{Case, Context, Words, body, each};
use crate::paths::{CASIMIR, Experiment, Source};
use crate::results::Row;

pub const CASE: Case = Case {
    words: Words {
        id: "extreme-normals",
        title: "Extreme normals",
        setup: "Rigid body with three noises, γ = ½cos 2t, 64 steps. Every increment is ±√τ·√(106 \
                ln 2) = ±8.57√τ, the largest that the generator can give, in all combinations of \
                signs; areas ±ΔW². With truncation (k = 4) and without.",
        mathematics: "Every increment is a possible one: the law holds on every path.",
        quantity: "largest relative distance of |y|² from its law, over the steps before the path \
                   ends",
        guarantee: "`sexp` in all forms: on the law to rounding, or a typed error where the \
                    equation has no solution on the branch of the flow.",
        varied: "τ",
        plot: None,
    },
    rows,
};

const TAUS: [f64; 3] = [1.0 / 1024.0, 1.0 / 64.0, 1.0 / 4.0];
const STEPS: u64 = 64;

fn rows(context: &Context) -> Result<Vec<Row>> {
    let truncations = [(", truncated", lab::truncation()), ("", Truncation::none())];
    let settings = TAUS.into_iter().flat_map(|tau| truncations.map(|truncation| (tau, truncation)));
    each(settings, |(tau, (words, truncation))| {
        // √(106 ln 2) is the radius of Box–Muller at the smallest uniform 2⁻⁵³.
        let largest = (106.0 * std::f64::consts::LN_2 * tau).sqrt();
        let size = largest.min(truncation.bound(tau)?);
        let noise: Box<Source<3>> = Box::new(move |_| {
            let mut drawn = 0;
            Box::new(move |noise| {
                drawn += 1;
                extreme(drawn / 3, size, noise);
            })
        });
        let experiment = body(context, half_cosine(), (STEPS, tau))?;
        let setting = format!("1/{:.0}{words}", 1.0 / tau);
        Experiment { truncation, noise: Some(noise), ..experiment }.law_rows(
            setting,
            &CASIMIR,
            |_| None,
        )
    })
}

/// Increments ±`size` with combination number `signs` of the signs, and areas ±`size`².
fn extreme(signs: u32, size: f64, noise: &mut BlockNoise<3>) {
    let sign = |m: u32| if signs >> m & 1 == 1 { -1.0 } else { 1.0 };
    let increments = [0, 1, 2].map(|m| sign(m) * size);
    let [a, b, c] = [0, 1, 2].map(|m| sign(m) * size * size);
    for p in 0..WIDTH {
        noise.increments.set_path(p, increments);
        noise.areas.set_path(p, [[0.0, a, b], [-a, 0.0, c], [-b, -c, 0.0]]);
    }
}
