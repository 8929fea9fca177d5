//! States from 10⁻¹⁵⁰ to 10¹⁵⁰.

use anyhow::Result;
use noise::WienerBlock;
use systems::paper::{INERTIA, NOISE_INERTIA, half_cosine, rigid_body_start};
use systems::{Problem, RigidBody};

use super::{Case, Context, Words};
use crate::paths::{Experiment, Path, Source, stops};
use crate::results::Row;
use crate::rounding::law_bound;
use crate::schemes::{Tested, schemes};

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
    let mut rows = Vec::new();
    let key = context.key;
    let without_areas: &Source<3> = &move |first_path| {
        let mut increments = WienerBlock::new(key, first_path);
        Box::new(move |noise| increments.increments(TAU.sqrt(), &mut noise.increments))
    };
    let problem = |scale: f64| -> Result<_> {
        let body =
            RigidBody::three_noises(INERTIA.map(|i| i * scale), NOISE_INERTIA.map(|i| i * scale))?;
        let start = rigid_body_start().map(|y| y * scale);
        Ok(Problem::new::<3>(body, half_cosine(), start, STEPS as f64 * TAU)?)
    };
    let plain = problem(1.0)?;
    let run = |problem: &Problem<_, _, 3>, scheme: &Tested<RigidBody<3>, 3, 3>| {
        Experiment { noise: Some(without_areas), ..Experiment::new(problem, STEPS, key)? }
            .run(scheme)
    };
    for exponent in EXPONENTS {
        let scale = 2f64.powi(exponent);
        let decimal = f64::from(exponent) * std::f64::consts::LOG10_2;
        let setting = format!("2^{exponent} ≈ 1e{decimal:+.0}");
        let scaled = problem(scale)?;
        for scheme in schemes(&plain.system, plain.y0) {
            let (plain, scaled) = (run(&plain, &scheme)?, run(&scaled, &scheme)?);
            let end = |paths: &[Path<3>]| paths[0].states[paths[0].states.len() - 1];
            let (a, b) = (end(&plain), end(&scaled));
            let difference = (0..3).map(|i| (b[i] / scale - a[i]).abs()).fold(0.0, f64::max);
            let x = Some(f64::from(exponent));
            let error = stops(&scaled).or(stops(&plain));
            let row = Row::observed(&setting, x, scheme.name, difference, error);
            rows.push(row.at_most(law_bound(STEPS, 1.0)));
        }
    }
    Ok(rows)
}
