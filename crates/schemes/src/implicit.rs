//! What the implicit schemes share: the equation z = start + change(start, z), on one path and on a block.

use nonlin::{BlockFixedPoint, BlockStatus, FixedPoint, Solution, Solver};
use real::{Block, Real};

/// The change over one step of an implicit scheme.
pub(crate) trait Rule<S, const D: usize, const M: usize>: Copy {
    /// The change from `start` to `z`. Must be `#[inline(always)]`.
    fn change<R: Real>(&self, system: &S, dw: [f64; M], start: [f64; D], z: [R; D]) -> [R; D];
}

/// The equation of one path.
struct PathEquation<'a, S, Q, const D: usize, const M: usize> {
    rule: Q,
    system: &'a S,
    dw: [f64; M],
    start: [f64; D],
}

impl<S, Q: Copy, const D: usize, const M: usize> Clone for PathEquation<'_, S, Q, D, M> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}
impl<S, Q: Copy, const D: usize, const M: usize> Copy for PathEquation<'_, S, Q, D, M> {}

impl<S, Q: Rule<S, D, M>, const D: usize, const M: usize> FixedPoint<D> for PathEquation<'_, S, Q, D, M> {
    #[inline(always)]
    fn start(&self) -> [f64; D] {
        self.start
    }

    #[inline(always)]
    fn map<R: Real>(&self, z: [R; D]) -> [R; D] {
        let mut next = self.rule.change(self.system, self.dw, self.start, z);
        for i in 0..D {
            next[i] = next[i] + self.start[i];
        }
        next
    }
}

/// The equations of a block.
struct BlockEquation<'a, S, Q, const D: usize, const M: usize> {
    rule: Q,
    system: &'a S,
    dw: &'a Block<M>,
    start: &'a Block<D>,
}

impl<'a, S, Q: Rule<S, D, M>, const D: usize, const M: usize> BlockFixedPoint<D> for BlockEquation<'a, S, Q, D, M> {
    type Path = PathEquation<'a, S, Q, D, M>;
    #[inline(always)]
    fn path(&self, p: usize) -> Self::Path {
        PathEquation { rule: self.rule, system: self.system, dw: self.dw.path(p), start: self.start.path(p) }
    }
}

/// Solves the equations of a block; to be called inside a kernel.
#[inline(always)]
pub(crate) fn solve_block<S, Q: Rule<S, D, M>, const D: usize, const M: usize>(
    solver: &Solver,
    rule: Q,
    system: &S,
    dw: &Block<M>,
    start: &Block<D>,
    status: &mut BlockStatus,
) -> Block<D> {
    let mut z = Block::zero();
    solver.solve_block(&BlockEquation { rule, system, dw, start }, &mut z, status);
    z
}

/// Solves the equation of one path.
pub(crate) fn solve_path<S, Q: Rule<S, D, M>, const D: usize, const M: usize>(
    solver: &Solver,
    rule: Q,
    system: &S,
    dw: [f64; M],
    start: [f64; D],
) -> Solution<D> {
    solver.solve(&PathEquation { rule, system, dw, start })
}
