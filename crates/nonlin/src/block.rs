//! The fast method on a block of paths.

use real::{Block, PathMask, WIDTH};

use crate::robust::solve_robust;
use crate::sweep::{Iterate, begins_otherwise, first_sweeps, settled_path, sweep};
use crate::{BlockFixedPoint, BlockStatus, FixedPoint, Method, Solver};

/// The paths of a block in two halves: path p of the first has its first sweep together with path p
/// of the second.
const HALF: usize = WIDTH / 2;

/// The state of the iteration on every path, kept small: it is what a sweep reads and writes.
struct Iterates<'a, const D: usize> {
    z: &'a mut Block<D>,
    /// Minus the number of sweeps on a path that is done, positive or NaN on one that is not.
    pending: &'a mut Block<1>,
}

impl<const D: usize> Iterates<'_, D> {
    /// The first sweep that the equations ask for; returns how many paths are not done.
    #[inline(always)]
    fn start<E: BlockFixedPoint<D>>(&mut self, equations: &E) -> u64 {
        // Counted in the width of the lanes, and wrapping: a narrower counter would be summed one
        // path at a time, and a checked one is a branch.
        let mut unfinished = 0u64;
        for p in 0..HALF {
            let (one, other) = first_sweeps(&equations.path(p), &equations.path(p + HALF));
            unfinished =
                unfinished.wrapping_add(self.set(p, one)).wrapping_add(self.set(p + HALF, other));
        }
        unfinished
    }

    /// Puts every path where its iteration starts.
    #[inline(always)]
    fn wait<E: BlockFixedPoint<D>>(&mut self, equations: &E) {
        for p in 0..WIDTH {
            self.set(p, (equations.path(p).start(), f64::INFINITY));
        }
    }

    /// Keeps the first sweep of path p; returns 1 if it is not done.
    #[inline(always)]
    fn set(&mut self, p: usize, (after, excess): Iterate<D>) -> u64 {
        let done = excess <= 0.0;
        self.z.set_path(p, after);
        self.pending.0[0][p] = if done { -1.0 } else { 1.0 };
        if done { 0 } else { 1 }
    }

    /// Sweep number `number`: from these iterates to the `next`, which are other memory. Written in
    /// place, the selects that freeze a path would become masked stores, which stall the loads of
    /// the next sweep.
    #[inline(always)]
    fn advance<E: BlockFixedPoint<D>>(
        &self,
        equations: &E,
        method: Method,
        number: u32,
        next: &mut Iterates<'_, D>,
    ) -> u64 {
        let number = f64::from(number);
        let mut unfinished = 0u64;
        for p in 0..WIDTH {
            let swept = sweep(&equations.path(p), self.z.path(p), method);
            unfinished = unfinished.wrapping_add(self.carry(p, number, swept, next));
        }
        unfinished
    }

    /// Keeps sweep number `number` of path p, if the path was not done before; returns 1 if it is
    /// not done now.
    #[inline(always)]
    fn carry(
        &self,
        p: usize,
        number: f64,
        (after, excess): Iterate<D>,
        next: &mut Iterates<'_, D>,
    ) -> u64 {
        let pending = self.pending.0[0][p];
        let frozen = pending <= 0.0;
        for i in 0..D {
            next.z.0[i][p] = if frozen { self.z.0[i][p] } else { after[i] };
        }
        // NaN is not at most zero, hence not done.
        let now = if excess <= 0.0 { -number } else { 1.0 };
        let now = if frozen { pending } else { now };
        next.pending.0[0][p] = now;
        if now <= 0.0 { 0 } else { 1 }
    }
}

impl Solver {
    /// Solves the equations of all paths; on return `z` holds the solutions.
    ///
    /// Meant to be called inside a `Kernel` of `real`, into which it is inlined. A path that is
    /// done is frozen by a select and never changes again, so a path's solution does not depend on
    /// its neighbours.
    #[inline(always)]
    pub fn solve_block<E: BlockFixedPoint<D>, const D: usize>(
        &self,
        equations: &E,
        z: &mut Block<D>,
        status: &mut BlockStatus,
    ) {
        match self.method.unwrap_or(E::Path::METHOD) {
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
        status.robust = PathMask::NONE;
        status.failed = PathMask::NONE;
        let mut iterates = Iterates { z, pending: &mut status.pending };
        let (mut unfinished, mut sweeps) = if begins_otherwise::<E::Path, D>(method) {
            (iterates.start(equations), 1)
        } else {
            iterates.wait(equations);
            (WIDTH as u64, 0)
        };
        while unfinished > 0 && sweeps < self.max_sweeps.max(1) {
            sweeps += 1;
            let (mut z, mut pending) = (*iterates.z, *iterates.pending);
            let last = Iterates { z: &mut z, pending: &mut pending };
            unfinished = last.advance(equations, method, sweeps, &mut iterates);
        }
        if self.settle {
            settle(equations, method, z);
        }
        if unfinished > 0 {
            // A copy: what a call that is not inlined may look at is kept in memory, and not in registers.
            rescue(*equations, z, status);
        }
    }
}

/// One more sweep on every path; of those that are not done the robust method makes something else.
#[inline(always)]
fn settle<E: BlockFixedPoint<D>, const D: usize>(equations: &E, method: Method, z: &mut Block<D>) {
    let mut settled = Block::zero();
    for p in 0..WIDTH {
        settled.set_path(p, settled_path(&equations.path(p), z.path(p), method));
    }
    *z = settled;
}

/// Hands every unfinished path to the robust method.
#[cold]
#[inline(never)]
fn rescue<E: BlockFixedPoint<D>, const D: usize>(
    equations: E,
    z: &mut Block<D>,
    status: &mut BlockStatus,
) {
    for p in 0..WIDTH {
        if status.pending.0[0][p] <= 0.0 {
            continue;
        }
        let solution = solve_robust(&equations.path(p));
        z.set_path(p, solution.z);
        status.set(p, solution.outcome);
    }
}
