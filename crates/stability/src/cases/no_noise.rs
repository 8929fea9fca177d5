//! Without noise: ordinary differential equations, and the deterministic orders.

use systems::PoissonSystem;

use super::{Claim, Context, Measured, Words, body, body_start, grid, half_cosine};
use crate::method::{Method, Noise};
use crate::path::Path;
use crate::results::{Case, Row};

/// Steps on [0, 1]; the errors of neighbours give a local order.
const STEPS: [u64; 4] = [64, 128, 256, 512];
/// The order differs from its limit by a multiple of τ; at the coarsest step here |p − p_∞| ≤ 16τ.
const SLACK: f64 = 16.0;

fn end<S: PoissonSystem<3, 3>>(
    system: &S,
    method: Method,
    steps: u64,
) -> Result<[f64; 3], crate::path::Stop> {
    let damping = half_cosine();
    let path = Path { system, damping: &damping, y0: body_start(), tau: 1.0 / steps as f64, steps };
    path.run(method, &mut || Noise::increments([0.0; 3]), &mut |_, _, _, _| ())
}

/// ln₂ of the quotient of two successive differences.
fn order(system: &impl PoissonSystem<3, 3>, method: Method, steps: u64) -> Measured {
    let ends = [steps, 2 * steps, 4 * steps].map(|steps| end(system, method, steps));
    match ends {
        [Ok(one), Ok(two), Ok(four)] => {
            let difference =
                |a: [f64; 3], b: [f64; 3]| super::length([a[0] - b[0], a[1] - b[1], a[2] - b[2]]);
            Measured { figure: (difference(one, two) / difference(two, four)).log2(), stop: None }
        }
        [one, two, four] => {
            Measured { figure: f64::NAN, stop: one.err().or(two.err()).or(four.err()) }
        }
    }
}

pub(super) fn case(context: &Context) -> Case {
    let system = body();
    let rows = grid(&STEPS, 3, |&steps, method| {
        let exact = if method == Method::EulerMaruyama { 1.0 } else { 2.0 };
        let measured = order(&system, method, steps);
        let bound = SLACK / steps as f64;
        let off = Measured { figure: (measured.figure - exact).abs(), ..measured };
        let verdict = Claim::AtMost(bound).row("", None, "", off).verdict;
        let row = Claim::Nothing.row(
            &format!("1/{steps}"),
            Some(1.0 / steps as f64),
            method.id(),
            measured,
        );
        Row { verdict, exact: Some(exact), bound: None, ..row }
    });
    Words {
        title: "No noise",
        setup: "Rigid body, γ = ½cos 2t, T = 1, all increments zero (and no Itô correction is due, but `em` makes it: its drift belongs to the equation with noise).",
        mathematics: "The equation is an ordinary one: `sexp`, `midpoint` and `heun` are of order two, Euler's method of order one.",
        quantity: "order, from the differences of the results with N, 2N and 4N steps",
        guarantee: "Two, and one for `em`, up to 16τ.",
        varied: "τ",
    }
    .with(context, rows)
}
