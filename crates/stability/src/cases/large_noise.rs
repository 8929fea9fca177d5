//! Increments past the contraction bound of the fixed point.

use schemes::{SexpLevy, Step};

use super::{Claim, Context, Measured, Words, body, grid, residual_share};
use crate::branch::{Branch, follow};
use crate::method::{Method, Noise};
use crate::results::{Case, Row};
use crate::rounding::law_bound;
use noise::WienerPath;
use systems::Constant;

/// Standard deviations of the increments. The fixed point contracts for sure while ‖ψ′‖ < 1, which
/// for this body and |y| = 1 is about max|kᵢ − kⱼ| < 1 with k = τ/I + ΔW/Î.
const SIZES: [f64; 6] = [0.1, 0.3, 1.0, 3.0, 10.0, 100.0];
const TAU: f64 = 0.1;

pub(super) fn case(context: &Context) -> Case {
    let samples = context.many(400, 40);
    // Where the branch leads is worked out once for each increment, by a method that knows nothing
    // of the solver.
    let branches: Vec<Vec<Branch<3>>> = SIZES
        .iter()
        .map(|&size| {
            (0..samples)
                .map(|number| follow(&body(), TAU, increment(context, number, size), start(number)))
                .collect()
        })
        .collect();
    let rows = grid(&[0, 1, 2, 3, 4, 5], 3, |&setting: &usize, method| {
        let (size, damping) = (SIZES[setting], valid_zero());
        let (mut other, mut refused, mut excess, mut missed) = (0u64, 0u64, 0.0f64, 0u64);
        for number in 0..samples {
            let (dw, y) = (increment(context, number, size), start(number));
            let levy = SexpLevy::new(&body(), y);
            let Ok(step) = Step::new(&damping, 0, TAU) else { continue };
            let solution = method.step(&body(), &levy, &step, Noise::increments(dw), y);
            if !solution.outcome.converged() {
                refused += 1;
                missed += u64::from(matches!(branches[setting][number as usize], Branch::Leads(_)));
                continue;
            }
            let defect = super::defect(&body(), 0, 2.0, (y, solution.z), 0.0);
            excess = excess
                .max(defect / (law_bound(1, 0.0) + residual_share(solution.outcome, solution.z)));
            if !branches[setting][number as usize].holds(solution.z) {
                other += 1;
            }
        }
        let share = other as f64 / samples as f64;
        let measured = Measured { figure: share, stop: None };
        let row = if method.conformal() {
            // Where the map contracts on the whole sphere there is one solution; beyond, the law
            // alone is promised.
            let inside = size <= SIZES[0];
            let kept = excess <= 1.0 && (!inside || other == 0 && refused == 0);
            let claim = if kept { Claim::Nothing } else { Claim::AtMost(-1.0) };
            let row = claim.row("", Some(size), method.id(), measured);
            let verdict = if kept { crate::results::Verdict::Holds } else { row.verdict };
            Row { verdict, bound: None, ..row }
        } else if method == Method::Midpoint {
            // The same equation as that of `sexp` without damping.
            Claim::Nothing.row("", Some(size), method.id(), measured)
        } else {
            Claim::Nothing.row(
                "",
                Some(size),
                method.id(),
                Measured { figure: f64::NAN, stop: None },
            )
        };
        let implicit = method.conformal() || method == Method::Midpoint;
        let verdict = if implicit { row.verdict } else { crate::results::Verdict::Observed };
        let error = (refused > 0)
            .then(|| format!("{refused} of {samples} not solved, {missed} of them solvable"));
        Row { setting: format!("{size}"), verdict, error, ..row }
    });
    Words {
        title: "Large noise",
        setup: "Rigid body with three noises, no damping, one step of τ = 0.1 from random states with |y| = 1; Gaussian increments of the given size, not truncated, no areas. \
                The branch of the flow is followed from a step of size zero in 2048 small steps of its own, with a test for turning points.",
        mathematics: "While the map contracts there is one solution. Beyond, there may be several; the one that belongs to the flow is on the branch that starts at the old \
                      state with increments of zero, if that branch does not turn back before.",
        quantity: "share of the steps whose solution is not on that branch",
        guarantee: "Inside the contraction bound (size 0.1) every step is solved, and by the right solution. Beyond, the Newton method with continuation takes over: what `sexp` \
                    returns solves its equation, so |y|² is kept to rounding, or the step says that it found no solution. That it is the right branch is \
                    not guaranteed there; the figure says how often it is not. `em` and `heun` solve nothing.",
        varied: "size of the increments",
    }
    .with(context, rows)
}

fn valid_zero() -> Constant {
    super::valid(Constant::new(0.0))
}

/// Increments number `number`: the same normals at every size.
fn increment(context: &Context, number: u64, size: f64) -> [f64; 3] {
    WienerPath::<3>::new(context.key(), number).increments(size)
}

/// A point on the unit sphere, on a spiral.
fn start(number: u64) -> [f64; 3] {
    let height = 2.0 * ((number as f64 + 0.5) * 0.618_033_988_749_894_8).fract() - 1.0;
    let (angle, radius) = (2.4 * number as f64, (1.0 - height * height).sqrt());
    [radius * real::elementary::cos(angle), radius * real::elementary::sin(angle), height]
}
