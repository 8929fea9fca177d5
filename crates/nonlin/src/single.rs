//! The fast method on one path.

use crate::robust::solve_robust;
use crate::sweep::{begins_otherwise, first_sweep, settled_path, sweep};
use crate::{FixedPoint, Outcome, Solution, Solver};

impl Solver {
    /// Solves one equation; the same bits as that path of [`solve_block`](Self::solve_block).
    #[must_use]
    pub fn solve<E: FixedPoint<D>, const D: usize>(&self, equation: &E) -> Solution<D> {
        let method = self.method.unwrap_or(E::METHOD);
        let ((mut z, mut excess), mut iterations) = if begins_otherwise::<E, D>(method) {
            (first_sweep(equation), 1)
        } else {
            ((equation.start(), f64::INFINITY), 0)
        };
        loop {
            // NaN is not at most zero, hence not done.
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
