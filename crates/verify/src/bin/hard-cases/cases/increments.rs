//! Increments that are extreme, steps that are big, and no noise at all.

use noise::{Noise, StepNoise, Truncation};
use real::WIDTH;
use systems::paper::half_cosine;
use verify::rounding::length;

use crate::{
    Case, Context, Rows, each,
    paths::{CASIMIR, Experiment, Law, body},
    row::Row,
    schemes::Family,
};

const SOLVABLE: &str = "`sexp` in all forms is on the law to rounding, or ends with a typed error. \
                        `sexp-li` and `split` are on the law to the end, and clip nothing. Nothing \
                        is guaranteed of the others.";

const LAW: Law = Law { to_the_end: &[Family::WithoutIteration], ..CASIMIR };

/// The largest normals that the generator can give, in all directions.
///
/// Rigid body with three noises, γ = ½cos 2t, 64 steps; truncated with k = 4 or not. Every
/// increment is ±√τ·√(106 ln 2) = ±8.57√τ, the largest the generator gives, in all combinations of
/// signs; areas ±ΔW².
///
/// Such increments are possible: the law holds on every path.
pub const EXTREME: Case = Case {
    id: "extreme-normals",
    quantity: super::SQUARED_LENGTH,
    guarantee: SOLVABLE,
    varied: "τ",
    rows: extreme,
};

fn extreme(context: &Context) -> Rows {
    let truncations = [(", truncated", verify::truncation()), ("", Truncation::none())];
    let taus = [1.0 / 1024.0, 1.0 / 64.0, 1.0 / 4.0].into_iter();
    each(taus.flat_map(|tau| truncations.map(|one| (tau, one))), |(tau, (words, truncation))| {
        // √(106 ln 2) is the radius of Box–Muller at the smallest uniform 2⁻⁵³.
        let largest = (106.0 * std::f64::consts::LN_2 * tau).sqrt();
        let size = largest.min(truncation.bound(tau)?);
        let experiment = body(context, half_cosine(), (64, tau))?.with_noise(move |_| {
            let mut drawn = 0;
            Box::new(move |noise| {
                drawn += 1;
                signed(drawn / 3, size, noise);
            })
        });
        let setting = format!("1/{:.0}{words}", 1.0 / tau);
        Experiment { truncation, ..experiment }.law_rows(setting, &LAW, |_| None)
    })
}

/// Increments ±`size` with combination number `signs` of the signs, and areas ±`size`².
fn signed(signs: u32, size: f64, noise: &mut StepNoise) {
    let sign = |m: u32| if signs >> m & 1 == 1 { -1.0 } else { 1.0 };
    let increments = [0, 1, 2].map(|m| sign(m) * size);
    let [a, b, c] = increments.map(|dw| dw * size);
    let signed = Noise { increments, areas: [[0.0, a, b], [-a, 0.0, c], [-b, -c, 0.0]] };
    (0..WIDTH).for_each(|p| noise.set_path(p, &signed));
}

/// Steps up to 0.9, where truncation is still defined.
///
/// Several paths of the rigid body with three noises, γ = ½cos 2t, 64 steps.
///
/// The scheme keeps the law for every τ at which its equation has a solution.
pub const BIG_STEPS: Case = Case {
    id: "big-steps",
    quantity: super::SQUARED_LENGTH,
    guarantee: SOLVABLE,
    varied: "τ",
    rows: big_steps,
};

fn big_steps(context: &Context) -> Rows {
    let paths = context.many(32, 4);
    each([0.1, 0.3, 0.5, 0.7, 0.9], |tau| {
        let experiment = body(context, half_cosine(), (64, tau))?;
        Experiment { paths, ..experiment }.law_rows(tau, &LAW, |_| None)
    })
}

/// Without noise: ordinary differential equations, and the deterministic orders.
///
/// Rigid body, γ = ½cos 2t, T = 1, all increments zero. `em` keeps its Itô correction.
///
/// For ordinary equations `sexp`, `midpoint` and `heun` are of order two, Euler's method of order
/// one.
pub const NO_NOISE: Case = Case {
    id: "no-noise",
    quantity: "order, from the results with N, 2N and 4N steps",
    guarantee: "Two, and one for `em`, up to 16τ.",
    varied: "τ",
    rows: no_noise,
};

/// The order differs from its limit by a multiple of τ; at the coarsest step here |p − p_∞| ≤ 16τ.
const SLACK: f64 = 16.0;

fn no_noise(context: &Context) -> Rows {
    let silent = |steps: u64| {
        let experiment = body(context, half_cosine(), (steps, 1.0 / steps as f64))?;
        anyhow::Ok(experiment.with_noise(|_| Box::new(|_| ())))
    };
    each([64, 128, 256, 512], |steps| {
        let finer = [silent(2 * steps)?, silent(4 * steps)?];
        silent(steps)?.rows(format!("1/{steps}"), |row, scheme, paths| {
            let end = |n: usize| anyhow::Ok(finer[n].run(scheme)?[0].end());
            let (one, two, four) = (paths[0].end(), end(0)?, end(1)?);
            let difference = |a: [f64; 3], b: [f64; 3]| length([0, 1, 2].map(|i| a[i] - b[i]));
            let order = (difference(one, two) / difference(two, four)).log2();
            let kept = row.error.is_none() && (order - scheme.order).abs() <= SLACK / steps as f64;
            let row = Row { exact: Some(scheme.order), ..row };
            Ok(row.with_figure(order).guaranteed(kept, None))
        })
    })
}
