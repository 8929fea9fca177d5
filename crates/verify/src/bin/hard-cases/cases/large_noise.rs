//! Increments past the contraction bound of the fixed point.

use noise::{Noise, WienerPath};
use nonlin::Outcome;
use real::elementary::{cos, sin};
use schemes::{Scheme, Step};
use systems::{Constant, PoissonSystem, RigidBody};
use verify::rounding::{law_bound, residual_share};

use super::branch::{agree, follow};
use crate::{
    Case, Context, Rows, each,
    paths::body,
    row::Row,
    schemes::{Family, Tested},
};

///
/// Rigid body with three noises, γ = 0, one step of τ = 0.1 from random states with |y| = 1;
/// Gaussian increments, not truncated, no areas. An independent solver follows the branch of the
/// flow in 2048 steps and detects turning points.
///
/// While the map contracts there is one solution. Beyond, the flow's is on the branch from the old
/// state at zero increments, if that does not turn back.
pub const CASE: Case = Case {
    id: "large-noise",
    quantity: "share of the steps whose solution is not on that branch",
    guarantee: "Inside the contraction bound (size 0.1) `sexp` solves every step on that branch. \
                Beyond, it keeps |y|² to rounding or fails; the branch is not guaranteed. `sexp-li` \
                and `split` solve every step and keep |y|² to rounding.",
    varied: "size of the increments",
    rows,
};

/// Standard deviations of the increments.
const SIZES: [f64; 6] = [0.1, 0.3, 1.0, 3.0, 10.0, 100.0];
/// The fixed point contracts for sure while ‖ψ′‖ < 1, which for this body and |y| = 1 is about
/// max|kᵢ − kⱼ| < 1 with k = τ/I + ΔW/Î.
const CONTRACTS: f64 = SIZES[0];
const TAU: f64 = 0.1;

fn rows(context: &Context) -> Rows {
    let samples = context.many(400, 40);
    let experiment = body(context, Constant::new(0.0)?, (1, TAU))?;
    let system = experiment.problem.system();
    let step = Step::new(experiment.problem.damping(), 0, TAU)?;
    each(SIZES, |size| {
        // The same normals at every size.
        let input = |number| {
            let (dw, y) =
                (WienerPath::<3>::new(context.key, number).increments(size), start(number));
            (dw, y, follow(system, TAU, dw, y))
        };
        let inputs: Vec<_> = (0..samples).map(input).collect();
        let row = |scheme: &Tested<RigidBody<3>, 3, 3>| {
            // Solutions on another branch; steps that were not solved; those of them that have a
            // solution; the largest quotient of the distance from |y|² and what is allowed.
            let (mut other, mut unsolved, mut missed, mut excess) = (0, 0, 0, 0.0_f64);
            for &(dw, y, branch) in &inputs {
                let solution = scheme.step(system, &step, &Noise::increments(dw), y);
                let (z, residual) = match solution.outcome {
                    Outcome::Failed { .. } => {
                        unsolved += 1;
                        missed += u64::from(branch.is_some());
                        continue;
                    }
                    Outcome::Robust { residual, .. } => (solution.z, residual),
                    Outcome::Fast { .. } => (solution.z, 0.0),
                };
                let defect = (system.invariant(0, z) / system.invariant(0, y) - 1.0).abs();
                let allowed = scheme.rounding * law_bound(1, 0.0) + residual_share(residual, z);
                excess = excess.max(defect / allowed);
                other += u64::from(!branch.is_some_and(|end| agree(z, end)));
            }
            let error = (unsolved > 0)
                .then(|| format!("{unsolved} of {samples} not solved, {missed} of them solvable"));
            let row = Row::new(size, scheme.name, error);
            let kept = excess <= 1.0 && (size > CONTRACTS || other == 0 && unsolved == 0);
            let share = other as f64 / samples as f64;
            match scheme.family {
                Family::Conformal => row.with_figure(share).guaranteed(kept, None),
                // They solve no equation that has branches.
                Family::WithoutIteration => row.guaranteed(excess <= 1.0 && unsolved == 0, None),
                // The same equation as that of `sexp` without damping.
                Family::Midpoint => row.with_figure(share),
                Family::Explicit => row,
            }
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
