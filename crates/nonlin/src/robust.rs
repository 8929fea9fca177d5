//! Newton's method with continuation, for paths on which the fast method fails.
//!
//! The homotopy z = z₀ + s(ψ(z) − z₀) connects the start z₀ at s = 0 with the equation at s = 1.
//! For an implicit step, s scales the Hamiltonian increment, so continuation follows the branch of
//! the flow. Newton's method from a distant start could find another branch.
//!
//! A step in s is accepted if it passes two tests; otherwise it is halved. First, Newton contracts
//! from its first iteration on (the monotonicity test of Deuflhard 2011, *Newton Methods for
//! Nonlinear Problems*, §5.1). Second, the Jacobian J = I − sψ′ changes little: ‖J⁻¹J′ − I‖ < 1 is
//! the affine-invariant condition of Newton–Mysovskikh for a unique root near the old one. The
//! first test alone checks one direction only and sometimes accepts another branch.

use crate::{
    FixedPoint, Outcome, Solution,
    criteria::{CONTRACTION, MAX_ITERATIONS, MIN_STEP, ROUND_OFF, TOLERANCE},
    elimination::solve_pivoted,
    sweep::{linearised, minus},
};

/// The largest ‖J⁻¹J′ − I‖₁ from one accepted step to the next.
const MAX_JACOBIAN_CHANGE: f64 = 0.5;

pub fn solve_robust<E: FixedPoint<D>, const D: usize>(equation: &E) -> Solution<D> {
    let start = equation.start();
    let (mut z, mut s, mut step, mut iterations) = (start, 0.0, 1.0, 0);
    // J = I at s = 0.
    let mut jacobian = [[0.0; D]; D];
    for i in 0..D {
        jacobian[i][i] = 1.0;
    }
    while s < 1.0 {
        let target = f64::min(s + step, 1.0);
        let found = newton(equation, &start, z, target, &mut iterations)
            .filter(|(_, found)| changed_little(&jacobian, found));
        if let Some(found) = found {
            ((z, jacobian), s) = (found, target);
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

/// Whether ‖J⁻¹J′ − I‖₁, the largest column sum, is at most [`MAX_JACOBIAN_CHANGE`]. False for NaN.
fn changed_little<const D: usize>(before: &[[f64; D]; D], after: &[[f64; D]; D]) -> bool {
    (0..D).all(|j| {
        let mut column = [0.0; D];
        for i in 0..D {
            column[i] = after[i][j];
        }
        let mut difference = solve_pivoted(*before, column);
        difference[j] -= 1.0;
        norm(&difference) <= MAX_JACOBIAN_CHANGE
    })
}

/// Newton's method for z − z₀ − s(ψ(z) − z₀) = 0: the solution and I − sψ′ at the last iterate but
/// one, if it converges. Iterations are added to `iterations`.
fn newton<E: FixedPoint<D>, const D: usize>(
    equation: &E,
    start: &[f64; D],
    mut z: [f64; D],
    s: f64,
    iterations: &mut u32,
) -> Option<([f64; D], [[f64; D]; D])> {
    let mut before = f64::INFINITY;
    for _ in 0..MAX_ITERATIONS {
        *iterations += 1;
        // I − sψ′ = (1 − s)I + s(I − ψ′), and likewise for the residual.
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
        // ψ(z) = z₀ + … is rounded relative to z₀, so ‖z‖ alone is too small near zero.
        let (length, size) = (norm(&change), norm(&z) + norm(start));
        let solved = length <= TOLERANCE * size;
        let contracts = length <= CONTRACTION * before;
        // With a NaN both are false, with an infinite change both are true.
        if solved || !contracts {
            // Small changes that no longer decrease are round-off, amplified by the condition of
            // I − sψ′.
            let converged = size.is_finite() && (solved || length <= ROUND_OFF * size);
            return converged.then_some((z, jacobian));
        }
        before = length;
    }
    None
}

fn residual<E: FixedPoint<D>, const D: usize>(equation: &E, z: [f64; D]) -> f64 {
    norm(&minus(z, equation.map(z)))
}

fn norm<const D: usize>(x: &[f64; D]) -> f64 {
    x.iter().map(|component| component.abs()).sum()
}
