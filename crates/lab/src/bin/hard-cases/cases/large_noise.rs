//! Increments past the contraction bound of the fixed point.

use anyhow::Result;
use noise::{Noise, WienerPath};
use nonlin::Outcome;
use real::elementary::{cos, sin};
use schemes::Step;
use systems::{Constant, PoissonSystem};

use super::branch::{agree, follow};
use super::{Case, Context, Words, body};
use crate::results::{Row, Verdict};
use crate::rounding::{law_bound, residual_share};
use crate::schemes::{Family, schemes};

pub const CASE: Case = Case {
    words: Words {
        id: "large-noise",
        title: "Large noise",
        setup: "Rigid body with three noises, no damping, one step of τ = 0.1 from random states \
                with |y| = 1; Gaussian increments of the given size, not truncated, no areas. The \
                branch of the flow is followed from a step of size zero in 2048 small steps of its \
                own, with a test for turning points.",
        mathematics: "While the map contracts there is one solution. Beyond, there may be several; \
                      the one that belongs to the flow is on the branch that starts at the old \
                      state with increments of zero, if that branch does not turn back before.",
        quantity: "share of the steps whose solution is not on that branch",
        guarantee: "Inside the contraction bound (size 0.1) every step is solved, and by the right \
                    solution. Beyond, the Newton method with continuation takes over: what `sexp` \
                    returns solves its equation, so |y|² is kept to rounding, or the step reports \
                    that it found no solution. That it is the right branch is not guaranteed there; \
                    the figure says how often it is not. `em` and `heun` solve nothing.",
        varied: "size of the increments",
        plot: None,
    },
    rows,
};

/// Standard deviations of the increments.
const SIZES: [f64; 6] = [0.1, 0.3, 1.0, 3.0, 10.0, 100.0];
/// The fixed point contracts for sure while ‖ψ′‖ < 1, which for this body and |y| = 1 is about
/// max|kᵢ − kⱼ| < 1 with k = τ/I + ΔW/Î.
const CONTRACTS: f64 = SIZES[0];
const TAU: f64 = 0.1;

/// What became of the steps.
#[derive(Default)]
struct Counts {
    /// Solutions on another branch.
    other: u64,
    /// Steps that were not solved.
    unsolved: u64,
    /// Steps that were not solved although the branch of the flow has a solution.
    missed: u64,
    /// The largest quotient of the distance from |y|² and what is allowed.
    excess: f64,
}

fn rows(context: &Context) -> Result<Vec<Row>> {
    let samples = context.arguments.many(400, 40);
    let problem = body(Constant::new(0.0)?, TAU)?;
    let (body, step) = (&problem.system, Step::new(&problem.damping, 0, TAU)?);
    let mut rows = Vec::new();
    for size in SIZES {
        // The same normals at every size.
        let inputs: Vec<_> = (0..samples)
            .map(|number| {
                let dw = WienerPath::<3>::new(context.key, number).increments(size);
                let y = start(number);
                (dw, y, follow(body, TAU, dw, y))
            })
            .collect();
        for scheme in schemes(body, problem.y0) {
            let mut counts = Counts::default();
            for &(dw, y, branch) in &inputs {
                let solution = scheme.step(body, &step, &Noise::increments(dw), y);
                let residual = match solution.outcome {
                    Outcome::Failed { .. } => {
                        counts.unsolved += 1;
                        counts.missed += u64::from(branch.is_some());
                        continue;
                    }
                    Outcome::Robust { residual, .. } => residual,
                    Outcome::Fast { .. } => 0.0,
                };
                let defect = (body.invariant(0, solution.z) / body.invariant(0, y) - 1.0).abs();
                let allowed = law_bound(1, 0.0) + residual_share(residual, solution.z);
                counts.excess = counts.excess.max(defect / allowed);
                counts.other += u64::from(!branch.is_some_and(|end| agree(solution.z, end)));
            }
            let Counts { other, unsolved, missed, excess } = counts;
            let (setting, share) = (format!("{size}"), other as f64 / samples as f64);
            let row = Row::observed(&setting, Some(size), scheme.name, share, None);
            let row = match scheme.family {
                Family::Conformal => {
                    let right = size > CONTRACTS || other == 0 && unsolved == 0;
                    row.guaranteed(excess <= 1.0 && right)
                }
                // The same equation as that of `sexp` without damping.
                Family::Midpoint => row,
                Family::Explicit => Row { measured: None, verdict: Verdict::Observed, ..row },
            };
            let error = format!("{unsolved} of {samples} not solved, {missed} of them solvable");
            rows.push(Row { error: (unsolved > 0).then_some(error), ..row });
        }
    }
    Ok(rows)
}

/// A point on the unit sphere, on a spiral.
fn start(number: u64) -> [f64; 3] {
    let height = 2.0 * ((number as f64 + 0.5) * 0.618_033_988_749_894_8).fract() - 1.0;
    let (angle, radius) = (2.4 * number as f64, (1.0 - height * height).sqrt());
    [radius * cos(angle), radius * sin(angle), height]
}
