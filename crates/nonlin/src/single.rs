//! The fast method on one path.

use crate::robust::solve_robust;
use crate::sweep::sweep;
use crate::{FixedPoint, Outcome, Solution, Solver};

impl Solver {
    /// Solves one equation; the same bits as that path of [`solve_block`](Self::solve_block).
    #[must_use]
    pub fn solve<E: FixedPoint<D>, const D: usize>(&self, equation: &E) -> Solution<D> {
        let mut z = equation.start();
        for iterations in 1..=self.max_sweeps.max(1) {
            let (next, excess) = sweep(equation, z, self.method, iterations == 1);
            z = next;
            if excess <= 0.0 {
                return Solution { z, outcome: Outcome::Fast { iterations } };
            }
        }
        solve_robust(equation)
    }
}
