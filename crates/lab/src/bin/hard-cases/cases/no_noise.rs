//! Without noise: ordinary differential equations, and the deterministic orders.

use anyhow::Result;
use systems::paper::half_cosine;

use super::{Case, Context, Words, body};
use crate::paths::{Experiment, Source, stops};
use crate::results::Row;
use crate::rounding::length;
use crate::schemes::schemes;

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
    let silence: &Source<3> = &|_| Box::new(|_| ());
    let problem = body(half_cosine(), 1.0)?;
    let mut rows = Vec::new();
    for steps in STEPS {
        let setting = format!("1/{steps}");
        for scheme in schemes(&problem.system, problem.y0) {
            let mut paths = Vec::new();
            for steps in [steps, 2 * steps, 4 * steps] {
                let experiment = Experiment::new(&problem, steps, context.key)?;
                paths.extend(Experiment { noise: Some(silence), ..experiment }.run(&scheme)?);
            }
            let end = |n: usize| paths[n].states[paths[n].states.len() - 1];
            let difference = |a: [f64; 3], b: [f64; 3]| length([0, 1, 2].map(|i| a[i] - b[i]));
            let order = (difference(end(0), end(1)) / difference(end(1), end(2))).log2();
            let error = stops(&paths);
            let kept = error.is_none() && (order - scheme.order).abs() <= SLACK / steps as f64;
            let x = Some(1.0 / steps as f64);
            let row = Row::observed(&setting, x, scheme.name, order, error);
            rows.push(row.with_exact(scheme.order).guaranteed(kept));
        }
    }
    Ok(rows)
}
