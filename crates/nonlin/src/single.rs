//! The fast method on one path.

use crate::{
    FixedPoint, Outcome, Solution, Solver,
    robust::solve_robust,
    sweep::{first_sweeps, has_first_sweep, settled_path, sweep},
};

impl Solver {
    /// Solves the equation of one path, with the same bits as in
    /// [`solve_block`](Self::solve_block).
    ///
    /// The fast method is tried first. If it does not converge in `max_sweeps` sweeps, Newton's
    /// method with continuation follows. If that fails as well, the outcome is [`Outcome::Failed`].
    pub fn solve<E: FixedPoint<D>, const D: usize>(&self, equation: &E) -> Solution<D> {
        let method = self.method.unwrap_or(E::METHOD);
        let ((mut z, mut excess), mut iterations) = if has_first_sweep::<E, D>(method) {
            // The compiler computes the two equal sweeps once.
            (first_sweeps(equation, equation).0, 1)
        } else {
            ((equation.start(), f64::INFINITY), 0)
        };
        loop {
            // A NaN counts as not converged.
            if excess <= 0.0 {
                let z = if self.settle { settled_path(equation, z, method) } else { z };
                return Solution { z, outcome: Outcome::Fast { iterations } };
            }
            if iterations >= self.max_sweeps.max(1) {
                return solve_robust(equation);
            }
            (z, excess) = sweep(equation, z, method);
            iterations += 1;
        }
    }
}
