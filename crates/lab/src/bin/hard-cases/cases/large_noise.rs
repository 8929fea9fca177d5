//! Increments past the contraction bound of the fixed point.

use anyhow::Result;
use noise::{Noise, WienerPath};
use nonlin::{Outcome, Solution};
use real::elementary::{cos, sin};
use schemes::Step;
use systems::{Constant, PoissonSystem, RigidBody};

use super::branch::{agree, follow};
use super::{Case, Context, Words, body, each};
use crate::results::Row;
use crate::rounding::{law_bound, residual_share};
use crate::schemes::{Family, Tested};

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
    let experiment = body(context, Constant::new(0.0)?, (1, TAU))?;
    let (system, step) =
        (experiment.problem.system, Step::new(&experiment.problem.damping, 0, TAU)?);
    each(SIZES, |size| {
        // The same normals at every size.
        let input = |number| {
            let dw = WienerPath::<3>::new(context.key, number).increments(size);
            (dw, start(number), follow(&system, TAU, dw, start(number)))
        };
        let inputs: Vec<_> = (0..samples).map(input).collect();
        let row = |scheme: &Tested<RigidBody<3>, 3, 3>| {
            let mut counts = Counts::default();
            for &(dw, y, branch) in &inputs {
                let Solution { z, outcome } =
                    scheme.step(&system, &step, &Noise::increments(dw), y);
                let residual = match outcome {
                    Outcome::Failed { .. } => {
                        counts.unsolved += 1;
                        counts.missed += u64::from(branch.is_some());
                        continue;
                    }
                    Outcome::Robust { residual, .. } => residual,
                    Outcome::Fast { .. } => 0.0,
                };
                let defect = (system.invariant(0, z) / system.invariant(0, y) - 1.0).abs();
                let allowed = law_bound(1, 0.0) + residual_share(residual, z);
                counts.excess = counts.excess.max(defect / allowed);
                counts.other += u64::from(!branch.is_some_and(|end| agree(z, end)));
            }
            let Counts { other, unsolved, missed, excess } = counts;
            let right = size > CONTRACTS || other == 0 && unsolved == 0;
            let row = Row::new(&size.into(), scheme.name, None);
            let share = other as f64 / samples as f64;
            let row = match scheme.family {
                Family::Conformal => {
                    row.with_figure(share).guaranteed(excess <= 1.0 && right, None)
                }
                // The same equation as that of `sexp` without damping.
                Family::Midpoint => row.with_figure(share),
                Family::Explicit => row,
            };
            let error = format!("{unsolved} of {samples} not solved, {missed} of them solvable");
            Row { error: (unsolved > 0).then_some(error), ..row }
        };
        Ok(experiment.schemes().iter().map(row).collect())
    })
}

/// A point on the unit sphere, on a spiral.
fn start(number: u64) -> [f64; 3] {
    let height = 2.0 * ((number as f64 + 0.5) * 0.618_033_988_749_894_8).fract() - 1.0;
    let (angle, radius) = (2.4 * number as f64, (1.0 - height * height).sqrt());
    [radius * cos(angle), radius * sin(angle), height]
}
