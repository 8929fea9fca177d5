//! Without noise: ordinary differential equations, and the deterministic orders.

use anyhow::Result;
use systems::paper::half_cosine;

use super::{Case, Context, Words, body, each};
use crate::paths::{Experiment, Source};
use crate::results::{Row, Setting};
use crate::rounding::length;

pub const CASE: Case = Case {
    words: Words {
        id: "no-noise",
        title: "No noise",
        setup: "Rigid body, γ = ½cos 2t, T = 1, all increments zero. No Itô correction is due, but \
                `em` makes it: its drift belongs to the equation with noise.",
        mathematics: "The equation is an ordinary one: `sexp`, `midpoint` and `heun` are of order \
                      two, Euler's method of order one.",
        quantity: "order, from the differences of the results with N, 2N and 4N steps",
        guarantee: "Two, and one for `em`, up to 16τ.",
        varied: "τ",
        plot: None,
    },
    rows,
};

/// Steps on [0, 1]; the errors of neighbours give a local order.
const STEPS: [u64; 4] = [64, 128, 256, 512];
/// The order differs from its limit by a multiple of τ; at the coarsest step here |p − p_∞| ≤ 16τ.
const SLACK: f64 = 16.0;

fn rows(context: &Context) -> Result<Vec<Row>> {
    let silent = |steps: u64| {
        let experiment = body(context, half_cosine(), (steps, 1.0 / steps as f64))?;
        let silence: Box<Source<3>> = Box::new(|_| Box::new(|_| ()));
        anyhow::Ok(Experiment { noise: Some(silence), ..experiment })
    };
    each(STEPS, |steps| {
        let setting = Setting { words: format!("1/{steps}"), x: Some(1.0 / steps as f64) };
        let finer = [silent(2 * steps)?, silent(4 * steps)?];
        silent(steps)?.rows(setting, |row, scheme, paths| {
            let end = |n: usize| anyhow::Ok(finer[n].run(scheme)?[0].end());
            let (one, two, four) = (paths[0].end(), end(0)?, end(1)?);
            let difference = |a: [f64; 3], b: [f64; 3]| length([0, 1, 2].map(|i| a[i] - b[i]));
            let order = (difference(one, two) / difference(two, four)).log2();
            let near = (order - scheme.order).abs() <= SLACK / steps as f64;
            let kept = row.error.is_none() && near;
            let row = row.with_figure(order).guaranteed(kept, None);
            Ok(Row { exact: Some(scheme.order), ..row })
        })
    })
}
