//! The fast method on a block of paths.

use real::{Block, PathMask, WIDTH};

use crate::FixedPoint as _;
use crate::robust::solve_robust;
use crate::sweep::sweep;
use crate::{BlockFixedPoint, BlockStatus, Method, Outcome, Solver};

/// The state of the iteration on every path, kept small: it is what a sweep reads and writes.
struct Iterates<const D: usize> {
    z: Block<D>,
    /// Minus the number of sweeps on a path that is done, positive or NaN on one that is not.
    pending: Block<1>,
}

impl<const D: usize> Iterates<D> {
    #[inline(always)]
    fn unset() -> Self {
        Self { z: Block::zero(), pending: Block::zero() }
    }

    /// The first sweep, from the starts of the equations; returns how many paths are not done.
    #[inline(always)]
    fn start<E: BlockFixedPoint<D>>(&mut self, equations: &E, method: Method) -> u64 {
        // Counted in the width of the lanes, and wrapping: a narrower counter would be summed one path at a time, and a
        // checked one is a branch.
        let mut unfinished = 0u64;
        for p in 0..WIDTH {
            let equation = equations.path(p);
            let (after, excess) = sweep(&equation, equation.start(), method, true);
            let done = excess <= 0.0;
            self.z.set_path(p, after);
            self.pending.0[0][p] = if done { -1.0 } else { 1.0 };
            unfinished = unfinished.wrapping_add(if done { 0 } else { 1 });
        }
        unfinished
    }

    /// Sweep number `number`: from these iterates to the `next`, which are other memory. Written in place, the
    /// selects that freeze a path would become masked stores, which stall the loads of the next sweep.
    #[inline(always)]
    fn advance<E: BlockFixedPoint<D>>(&self, equations: &E, method: Method, number: u32, next: &mut Self) -> u64 {
        let number = f64::from(number);
        let mut unfinished = 0u64;
        for p in 0..WIDTH {
            let before = self.z.path(p);
            let (after, excess) = sweep(&equations.path(p), before, method, false);
            let pending = self.pending.0[0][p];
            let frozen = pending <= 0.0;
            for i in 0..D {
                next.z.0[i][p] = if frozen { before[i] } else { after[i] };
            }
            // NaN is not at most zero, hence not done.
            let now = if excess <= 0.0 { -number } else { 1.0 };
            let now = if frozen { pending } else { now };
            next.pending.0[0][p] = now;
            unfinished = unfinished.wrapping_add(if now <= 0.0 { 0 } else { 1 });
        }
        unfinished
    }
}

impl Solver {
    /// Solves the equations of all paths; on return `z` holds the solutions.
    ///
    /// Meant to be called inside a [`real::Kernel`], into which it is inlined. A path that is done is frozen by a
    /// select and never changes again, so a path's solution does not depend on its neighbours.
    #[inline(always)]
    pub fn solve_block<E: BlockFixedPoint<D>, const D: usize>(
        &self,
        equations: &E,
        z: &mut Block<D>,
        status: &mut BlockStatus,
    ) {
        match self.method {
            Method::FixedPoint => self.iterate(equations, Method::FixedPoint, z, status),
            Method::Newton => self.iterate(equations, Method::Newton, z, status),
        }
    }

    #[inline(always)]
    fn iterate<E: BlockFixedPoint<D>, const D: usize>(
        &self,
        equations: &E,
        method: Method,
        z: &mut Block<D>,
        status: &mut BlockStatus,
    ) {
        let (mut even, mut odd) = (Iterates::unset(), Iterates::unset());
        let mut unfinished = odd.start(equations, method);
        let mut sweeps = 1;
        while unfinished > 0 && sweeps < self.max_sweeps {
            sweeps += 1;
            unfinished = odd.advance(equations, method, sweeps, &mut even);
            if unfinished == 0 || sweeps >= self.max_sweeps {
                return finish(equations, &even, unfinished, z, status);
            }
            sweeps += 1;
            unfinished = even.advance(equations, method, sweeps, &mut odd);
        }
        finish(equations, &odd, unfinished, z, status);
    }
}

#[inline(always)]
fn finish<E: BlockFixedPoint<D>, const D: usize>(
    equations: &E,
    iterates: &Iterates<D>,
    unfinished: u64,
    z: &mut Block<D>,
    status: &mut BlockStatus,
) {
    *z = iterates.z;
    status.pending = iterates.pending;
    status.robust = PathMask::NONE;
    status.failed = PathMask::NONE;
    if unfinished > 0 {
        rescue(equations, z, status);
    }
}

/// Hands every unfinished path to the robust method.
#[cold]
#[inline(never)]
fn rescue<E: BlockFixedPoint<D>, const D: usize>(equations: &E, z: &mut Block<D>, status: &mut BlockStatus) {
    for p in 0..WIDTH {
        if status.pending.0[0][p] <= 0.0 {
            continue;
        }
        let solution = solve_robust(&equations.path(p));
        z.set_path(p, solution.z);
        match solution.outcome {
            Outcome::Failed { residual } => {
                status.failed.insert(p);
                status.pending.0[0][p] = residual;
            }
            Outcome::Robust { iterations, .. } | Outcome::Fast { iterations, .. } => {
                status.robust.insert(p);
                status.pending.0[0][p] = -f64::from(iterations);
            }
        }
    }
}
