//! The fast method on one path.

use crate::{
    FixedPoint, Method, Outcome, Solution, Solver,
    robust::solve_robust,
    sweep::{first_sweeps, has_first_sweep, prefers_newton, settled_path, sweep},
};

/// Solves the equation of one path by the method that it prefers, with default options: as
/// [`Solver::solve`], but without the code of the other method.
pub fn solve<E: FixedPoint<D>, const D: usize>(equation: &E) -> Solution<D> {
    if const { prefers_newton::<E, D>() } {
        Solver::DEFAULT.by::<E, D, true, false>(equation)
    } else {
        Solver::DEFAULT.by::<E, D, false, false>(equation)
    }
}

impl Solver {
    /// Solves the equation of one path, with the same bits as in
    /// [`solve_block`](Self::solve_block).
    ///
    /// The fast method is tried first. If it does not converge in `max_sweeps` sweeps, Newton's
    /// method with continuation follows. If that fails as well, the outcome is [`Outcome::Failed`].
    pub fn solve<E: FixedPoint<D>, const D: usize>(&self, equation: &E) -> Solution<D> {
        match self.method.unwrap_or(E::METHOD) {
            Method::FixedPoint => self.by::<E, D, false, true>(equation),
            Method::Newton => self.by::<E, D, true, true>(equation),
        }
    }

    /// The solution by one method; only if `SETTLES` one more sweep may follow.
    fn by<E: FixedPoint<D>, const D: usize, const NEWTON: bool, const SETTLES: bool>(
        &self,
        equation: &E,
    ) -> Solution<D> {
        let ((mut z, mut excess), mut iterations) = if const { has_first_sweep::<E, D, NEWTON>() } {
            // The compiler computes the two equal sweeps once.
            (first_sweeps(equation, equation).0, 1)
        } else {
            ((equation.start(), f64::INFINITY), 0)
        };
        loop {
            // A NaN counts as not converged.
            if excess <= 0.0 {
                if SETTLES && self.settle {
                    z = settled_path::<E, D, NEWTON>(equation, z);
                }
                return Solution { z, outcome: Outcome::Fast { iterations } };
            }
            if iterations >= self.max_sweeps.max(1) {
                return solve_robust(equation);
            }
            (z, excess) = sweep::<E, D, NEWTON>(equation, z);
            iterations += 1;
        }
    }
}
