//! States from 10⁻¹⁵⁰ to 10¹⁵⁰.

use anyhow::Result;
use noise::WienerBlock;
use systems::RigidBody;
use systems::paper::{INERTIA, NOISE_INERTIA, half_cosine, rigid_body_start};

use super::{Case, Context, Words, each};
use crate::paths::{Experiment, Source};
use crate::results::{Row, Setting};
use crate::rounding::law_bound;

pub const CASE: Case = Case {
    words: Words {
        id: "scales",
        title: "Tiny and huge states",
        setup: "Rigid body with three noises, γ = ½cos 2t, 64 steps of τ = 1/64, truncated \
                increments; state and moments of inertia multiplied by a power of two.",
        mathematics: "With y and I multiplied by the same number the solution is multiplied by it; \
                      so it is in floating point, bit by bit, where nothing overflows or \
                      underflows.",
        quantity: "largest difference, relative to |y₀|, between the scaled solution and that of \
                   scale one",
        guarantee: "No scheme and no stopping test depends on the scale: at most a sweep more or \
                    less, a difference of rounding. `sexp-levy` runs without areas, whose weights \
                    1/Î² overflow or underflow.",
        varied: "scale",
        plot: None,
    },
    rows,
};

/// Powers of two next to 10⁻¹⁵⁰ … 10¹⁵⁰.
const EXPONENTS: [i32; 6] = [-498, -332, -166, 166, 332, 498];
const TAU: f64 = 1.0 / 64.0;
const STEPS: u64 = 64;

fn rows(context: &Context) -> Result<Vec<Row>> {
    let key = context.key;
    let scaled = |scale: f64| {
        let [body, noise] = [INERTIA, NOISE_INERTIA].map(|inertia| inertia.map(|i| i * scale));
        let system = (RigidBody::three_noises(body, noise)?, half_cosine());
        let start = rigid_body_start().map(|y| y * scale);
        let without_areas: Box<Source<3>> = Box::new(move |first_path| {
            let mut increments = WienerBlock::new(key, first_path);
            Box::new(move |noise| increments.increments(TAU.sqrt(), &mut noise.increments))
        });
        let experiment = Experiment::new(context, system, start, (STEPS, TAU))?;
        anyhow::Ok(Experiment { noise: Some(without_areas), ..experiment })
    };
    let plain = scaled(1.0)?;
    each(EXPONENTS, |exponent| {
        let scale = 2f64.powi(exponent);
        let decimal = f64::from(exponent) * std::f64::consts::LOG10_2;
        let words = format!("2^{exponent} ≈ 1e{decimal:+.0}");
        let setting = Setting { words, x: Some(f64::from(exponent)) };
        scaled(scale)?.rows(setting, |row, scheme, paths| {
            let (a, b) = (plain.run(scheme)?[0].end(), paths[0].end());
            let difference = (0..3).map(|i| (b[i] / scale - a[i]).abs()).fold(0.0, f64::max);
            Ok(row.with_figure(difference).at_most(law_bound(STEPS, 1.0)))
        })
    })
}
