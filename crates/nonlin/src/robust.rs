//! Newton's method with continuation, for the paths that the fast method cannot do.
//!
//! The family z = z₀ + s(ψ(z) − z₀) leads from the start z₀ at s = 0 to the equation at s = 1. For
//! an implicit step s scales the Hamiltonian increment, so the branch that is followed is the one
//! that belongs to the flow; a Newton method started far away could land on another. A step in s is
//! accepted when Newton contracts from its first iteration on (the monotonicity test of Deuflhard,
//! *Newton Methods for Nonlinear Problems*, 2011, §5.1) and the Jacobian J = I − sψ′ has changed
//! little, else it is halved. The second test is the affine-invariant condition ‖J⁻¹J′ − I‖ < 1 of
//! Newton and Mysovskikh for one root only near the old one; contraction alone is a test of one
//! direction, and passes now and then on the way to another branch.

use crate::elimination::solve_pivoted;
use crate::sweep::{TOLERANCE, linearised};
use crate::{FixedPoint, Outcome, Solution};

/// Newton iterations at one s. Contracting by [`CONTRACTION`] at first and quadratically soon
/// after, ten reach round-off, and twenty leave room for a slow start.
const MAX_ITERATIONS: u32 = 20;
/// Each Newton change must be at most this fraction of the one before.
const CONTRACTION: f64 = 0.5;
/// The largest ‖J⁻¹J′ − I‖₁ from one accepted step to the next.
const LARGEST_TURN: f64 = 0.5;
/// The smallest step in s that is tried. The first step is about LARGEST_TURN/‖ψ′‖, so this admits
/// ‖ψ′‖ up to 8000.
const MIN_STEP: f64 = 1.0 / 16384.0;

pub(crate) fn solve_robust<E: FixedPoint<D>, const D: usize>(equation: &E) -> Solution<D> {
    let start = equation.start();
    let (mut z, mut s, mut step, mut iterations) = (start, 0.0, 1.0, 0);
    // J = I at s = 0.
    let mut jacobian = [[0.0; D]; D];
    for i in 0..D {
        jacobian[i][i] = 1.0;
    }
    while s < 1.0 {
        let target = f64::min(s + step, 1.0);
        let attempt = newton(equation, &start, z, target);
        iterations += attempt.iterations;
        if attempt.converged && turned_little(&jacobian, &attempt.jacobian) {
            (z, s, jacobian) = (attempt.z, target, attempt.jacobian);
            step *= 2.0;
        } else {
            step *= 0.5;
            if step < MIN_STEP {
                return Solution {
                    z,
                    outcome: Outcome::Failed { residual: residual(equation, z) },
                };
            }
        }
    }
    Solution { z, outcome: Outcome::Robust { iterations, residual: residual(equation, z) } }
}

/// Whether ‖J⁻¹J′ − I‖₁, the largest sum of a column, is at most [`LARGEST_TURN`]; a NaN is not.
fn turned_little<const D: usize>(before: &[[f64; D]; D], after: &[[f64; D]; D]) -> bool {
    (0..D).all(|j| {
        let mut column = [0.0; D];
        for i in 0..D {
            column[i] = after[i][j];
        }
        let mut difference = solve_pivoted(*before, column);
        difference[j] -= 1.0;
        norm(&difference) <= LARGEST_TURN
    })
}

struct Attempt<const D: usize> {
    z: [f64; D],
    /// I − sψ′ where the last change was computed.
    jacobian: [[f64; D]; D],
    converged: bool,
    iterations: u32,
}

/// Newton on z − z₀ − s(ψ(z) − z₀) = 0.
fn newton<E: FixedPoint<D>, const D: usize>(
    equation: &E,
    start: &[f64; D],
    mut z: [f64; D],
    s: f64,
) -> Attempt<D> {
    let mut before = f64::INFINITY;
    let mut iterations = 0;
    loop {
        iterations += 1;
        // I − sψ′ = (1 − s)I + s(I − ψ′), and the defect likewise.
        let (mut jacobian, mut defect) = linearised(equation, z);
        for i in 0..D {
            for j in 0..D {
                jacobian[i][j] *= s;
            }
            jacobian[i][i] += 1.0 - s;
            defect[i] = (1.0 - s) * (z[i] - start[i]) + s * defect[i];
        }
        let change = solve_pivoted(jacobian, defect);
        for i in 0..D {
            z[i] -= change[i];
        }
        // Not ‖z‖ alone: ψ(z) = z₀ + … is rounded relative to z₀ even where the solution is close
        // to zero.
        let (length, size) = (norm(&change), norm(&z) + norm(start));
        let solved = length <= TOLERANCE * size;
        let contracts = length <= CONTRACTION * before;
        // A NaN neither solves nor contracts, an infinity does both.
        if solved || !contracts || iterations == MAX_ITERATIONS {
            // Changes that no longer shrink are round-off when they are small: the equation's own
            // noise, which the condition of I − sψ′ amplifies.
            return Attempt {
                z,
                jacobian,
                converged: size.is_finite() && (solved || !contracts && length <= ROUND_OFF * size),
                iterations,
            };
        }
        before = length;
    }
}

/// Changes that stagnate below this fraction of the unknowns are round-off, √ε: the accuracy that
/// is attainable at a double root, where I − sψ′ is singular. A regular Newton iteration so close
/// to its solution would converge.
const ROUND_OFF: f64 = 1.0 / (1u64 << 26) as f64;

fn residual<E: FixedPoint<D>, const D: usize>(equation: &E, z: [f64; D]) -> f64 {
    let (_, defect) = linearised(equation, z);
    norm(&defect)
}

fn norm<const D: usize>(x: &[f64; D]) -> f64 {
    x.iter().map(|component| component.abs()).sum()
}
