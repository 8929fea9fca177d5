//! Newton's method with continuation, for the paths that the fast method cannot do.
//!
//! The family z = z₀ + s(ψ(z) − z₀) leads from the start z₀ at s = 0 to the equation at s = 1. For an implicit step s
//! scales the Hamiltonian increment, so the branch that is followed is the one that belongs to the flow; a Newton
//! method started far away could land on another. A step in s is accepted when Newton contracts from its first
//! iteration on (the monotonicity test of Deuflhard, *Newton Methods for Nonlinear Problems*, 2011, §5.1), else it
//! is halved.

use crate::elimination::solve_pivoted;
use crate::sweep::{TOLERANCE, linearised};
use crate::{FixedPoint, Outcome, Solution};

/// Newton iterations at one s. Contracting by [`CONTRACTION`] at first and quadratically soon after, ten reach
/// round-off.
const MAX_ITERATIONS: u32 = 20;
/// Each Newton change must be at most this fraction of the one before.
const CONTRACTION: f64 = 0.5;
/// The smallest step in s that is tried.
const MIN_STEP: f64 = 1.0 / 1024.0;

pub(crate) fn solve_robust<E: FixedPoint<D>, const D: usize>(equation: &E) -> Solution<D> {
    let start = equation.start();
    let (mut z, mut s, mut step, mut iterations) = (start, 0.0, 1.0, 0);
    while s < 1.0 {
        let target = f64::min(s + step, 1.0);
        let attempt = newton(equation, &start, z, target);
        iterations += attempt.iterations;
        if attempt.converged {
            (z, s) = (attempt.z, target);
            step *= 2.0;
        } else {
            step *= 0.5;
            if step < MIN_STEP {
                return Solution {
                    z,
                    outcome: Outcome::Failed {
                        residual: residual(equation, z),
                    },
                };
            }
        }
    }
    Solution {
        z,
        outcome: Outcome::Robust {
            iterations,
            residual: residual(equation, z),
        },
    }
}

struct Attempt<const D: usize> {
    z: [f64; D],
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
    for iterations in 1..=MAX_ITERATIONS {
        // I − sψ′ = (1 − s)I + s(I − ψ′), and the defect likewise.
        let (mut matrix, mut defect) = linearised(equation, z);
        for i in 0..D {
            for j in 0..D {
                matrix[i][j] *= s;
            }
            matrix[i][i] += 1.0 - s;
            defect[i] = (1.0 - s) * (z[i] - start[i]) + s * defect[i];
        }
        let change = solve_pivoted(matrix, defect);
        for i in 0..D {
            z[i] -= change[i];
        }
        let (length, size) = (norm(&change), norm(&z));
        if !length.is_finite() {
            return Attempt {
                z,
                converged: false,
                iterations,
            };
        }
        if length <= TOLERANCE * size {
            return Attempt {
                z,
                converged: true,
                iterations,
            };
        }
        if length > CONTRACTION * before {
            // Changes that no longer shrink are round-off when they are small: the equation's own noise, which
            // the condition of I − sψ′ amplifies.
            return Attempt {
                z,
                converged: length <= ROUND_OFF * size,
                iterations,
            };
        }
        before = length;
    }
    Attempt {
        z,
        converged: false,
        iterations: MAX_ITERATIONS,
    }
}

/// Stagnation below this fraction of ‖z‖ is round-off: [`TOLERANCE`] amplified by a condition number of 2⁸.
const ROUND_OFF: f64 = 256.0 * TOLERANCE;

fn residual<E: FixedPoint<D>, const D: usize>(equation: &E, z: [f64; D]) -> f64 {
    let (_, defect) = linearised(equation, z);
    norm(&defect)
}

fn norm<const D: usize>(x: &[f64; D]) -> f64 {
    x.iter().map(|component| component.abs()).sum()
}
