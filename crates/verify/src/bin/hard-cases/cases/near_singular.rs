//! A linear equation that is singular or nearly so.

use noise::Noise;
use nonlin::Outcome;
use real::Real;
use schemes::{Scheme, SexpLi, Step};
use systems::{Constant, Invariant, PoissonSystem};
use verify::rounding::length;

use crate::{Case, Context, Rows, each, row::Row};

///
/// B(y)v = K(y × v), K = diag(1, 1, −1), H₁ = y₁, one step of `sexp-li` with ΔW = 2(1 − δ): (y₂,
/// y₃) are boosted, and I − ½A has the determinant 1 − ¼ΔW².
///
/// |z| grows like 1/δ with y₁² + y₂² − y₃² kept. At δ = 0 there is no solution.
pub const CASE: Case = Case {
    id: "near-singular",
    quantity: "change of y₁² + y₂² − y₃², relative to (|y| + |z|)²",
    guarantee: "32ε whatever the condition, or a typed error.",
    varied: "δ",
    rows,
};

/// so(2,1) with one noise along an axis.
struct Hyperbolic;

impl PoissonSystem<3, 1> for Hyperbolic {
    fn name(&self) -> &'static str {
        "hyperbolic"
    }
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        let along = y[1] * v[0] - y[0] * v[1];
        [y[1] * v[2] - y[2] * v[1], y[2] * v[0] - y[0] * v[2], along]
    }
    fn energy<R: Real>(&self, y: [R; 3], _dt: f64, dw: [f64; 1]) -> R {
        y[0] * dw[0]
    }
    fn invariants(&self) -> Vec<Invariant> {
        vec![Invariant::quadratic_casimir("C", "y₁² + y₂² − y₃²")]
    }
    fn invariant<R: Real>(&self, _index: usize, y: [R; 3]) -> R {
        y[0] * y[0] + y[1] * y[1] - y[2] * y[2]
    }
}

/// The rounding of the determinant scales the change of the state: C changes by a multiple of its
/// own value. Otherwise products of the adjugate, z and C are rounded: fewer than 64 halves of ε,
/// each times at most (|y| + |z|)².
const BOUND: f64 = 32.0 * f64::EPSILON;
const START: [f64; 3] = [0.3, 0.8, 0.1];

fn rows(_: &Context) -> Rows {
    let scheme = SexpLi::new(&Hyperbolic, START)?;
    let step = Step::new(&Constant::new(0.0)?, 0, 0.1)?;
    each([0.5, 1e-2, 1e-5, 1e-10, 1e-15, 0.0], |delta: f64| {
        let noise = Noise::increments([2.0 * (1.0 - delta)]);
        let solution = scheme.step(&Hyperbolic, &step, &noise, START);
        let failed = matches!(solution.outcome, Outcome::Failed { .. });
        let row = Row::new(delta, "sexp-li", failed.then(|| "no solution".into()));
        if failed {
            return Ok(vec![row.guaranteed(true, None)]);
        }
        let value = |y| PoissonSystem::<3, 1>::invariant(&Hyperbolic, 0, y);
        let size = length(START) + length(solution.z);
        let change: f64 = value(solution.z) - value(START);
        Ok(vec![row.with_figure(change.abs() / (size * size)).at_most(BOUND)])
    })
}
