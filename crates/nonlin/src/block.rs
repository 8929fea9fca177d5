//! The fast method on a block of paths.

use real::{Block, PathMask, WIDTH};

use crate::{
    BlockFixedPoint, BlockStatus, FixedPoint, Method, Solver,
    robust::solve_robust,
    sweep::{Iterate, first_sweeps, has_first_sweep, prefers_newton, settled_path, sweep},
};

/// Half of a block: paths p and p + [`HALF`] make their first sweeps together.
const HALF: usize = WIDTH / 2;

/// The state of the iteration on every path: what a sweep reads and writes.
struct Iterates<'a, const D: usize> {
    z: &'a mut Block<D>,
    /// Minus the number of sweeps of a converged path; positive or NaN on other paths.
    pending: &'a mut Block<1>,
}

impl<const D: usize> Iterates<'_, D> {
    /// The first sweep. Returns the number of paths that have not converged.
    #[inline(always)]
    fn start<E: BlockFixedPoint<D>>(&mut self, equations: &E) -> u64 {
        // The counter has the width of the lanes; a narrower one would be summed path by path. It
        // wraps, since an overflow check is a branch.
        let mut unfinished = 0u64;
        for p in 0..HALF {
            let (one, other) = first_sweeps(&equations.path(p), &equations.path(p + HALF));
            unfinished =
                unfinished.wrapping_add(self.set(p, one)).wrapping_add(self.set(p + HALF, other));
        }
        unfinished
    }

    /// Sets every path to its start.
    #[inline(always)]
    fn wait<E: BlockFixedPoint<D>>(&mut self, equations: &E) {
        for p in 0..WIDTH {
            self.set(p, (equations.path(p).start(), f64::INFINITY));
        }
    }

    /// Stores the first sweep of path p. Returns 1 if it has not converged.
    #[inline(always)]
    fn set(&mut self, p: usize, (after, excess): Iterate<D>) -> u64 {
        let done = excess <= 0.0;
        self.z.set_path(p, after);
        self.pending.0[0][p] = if done { -1.0 } else { 1.0 };
        if done { 0 } else { 1 }
    }

    /// Sweep number `number`, from these iterates to `next` in other memory. In place, the selects
    /// that freeze a path would become masked stores, which stall the loads of the next sweep.
    /// Returns the number of paths that have not converged.
    #[inline(always)]
    fn advance<E: BlockFixedPoint<D>, const NEWTON: bool>(
        &self,
        equations: &E,
        number: u32,
        next: &mut Iterates<'_, D>,
    ) -> u64 {
        let number = f64::from(number);
        let mut unfinished = 0u64;
        for p in 0..WIDTH {
            let (after, excess) = sweep::<E::Path, D, NEWTON>(&equations.path(p), self.z.path(p));
            let pending = self.pending.0[0][p];
            let frozen = pending <= 0.0;
            for i in 0..D {
                next.z.0[i][p] = if frozen { self.z.0[i][p] } else { after[i] };
            }
            // A NaN counts as not converged.
            let now = if excess <= 0.0 { -number } else { 1.0 };
            let now = if frozen { pending } else { now };
            next.pending.0[0][p] = now;
            unfinished = unfinished.wrapping_add(if now <= 0.0 { 0 } else { 1 });
        }
        unfinished
    }
}

/// Solves the equations of all paths by the method that they prefer, with default options: as
/// [`Solver::solve_block`], but without the code of the other method.
#[inline(always)]
pub fn solve_block<E: BlockFixedPoint<D>, const D: usize>(
    equations: &E,
    z: &mut Block<D>,
    status: &mut BlockStatus,
) {
    if const { prefers_newton::<E::Path, D>() } {
        Solver::DEFAULT.iterate::<E, D, true, false>(equations, z, status);
    } else {
        Solver::DEFAULT.iterate::<E, D, false, false>(equations, z, status);
    }
}

impl Solver {
    /// Solves the equations of all paths and writes the solutions into `z`. A path marked
    /// [`failed`](BlockStatus::failed) holds the last iterate.
    ///
    /// Call it inside a `Kernel` of `real`, into which it is inlined. A select freezes every
    /// converged path, so the solution of a path does not depend on the other paths.
    #[inline(always)]
    pub fn solve_block<E: BlockFixedPoint<D>, const D: usize>(
        &self,
        equations: &E,
        z: &mut Block<D>,
        status: &mut BlockStatus,
    ) {
        match self.method.unwrap_or(E::Path::METHOD) {
            Method::FixedPoint => self.iterate::<E, D, false, true>(equations, z, status),
            Method::Newton => self.iterate::<E, D, true, true>(equations, z, status),
        }
    }

    #[inline(always)]
    fn iterate<E: BlockFixedPoint<D>, const D: usize, const NEWTON: bool, const SETTLES: bool>(
        &self,
        equations: &E,
        z: &mut Block<D>,
        status: &mut BlockStatus,
    ) {
        status.robust = PathMask::NONE;
        status.failed = PathMask::NONE;
        let mut iterates = Iterates { z, pending: &mut status.pending };
        let (mut unfinished, mut sweeps) = if const { has_first_sweep::<E::Path, D, NEWTON>() } {
            (iterates.start(equations), 1)
        } else {
            iterates.wait(equations);
            (WIDTH as u64, 0)
        };
        while unfinished > 0 && sweeps < self.max_sweeps.max(1) {
            sweeps += 1;
            let (mut z, mut pending) = (*iterates.z, *iterates.pending);
            let last = Iterates { z: &mut z, pending: &mut pending };
            unfinished = last.advance::<E, NEWTON>(equations, sweeps, &mut iterates);
        }
        if SETTLES && self.settle {
            settle::<E, D, NEWTON>(equations, z);
        }
        if unfinished > 0 {
            // A copy, since a reference passed to a function that is not inlined keeps the
            // equations in memory instead of registers.
            solve_unfinished(*equations, z, status);
        }
    }
}

/// One more sweep on every path. The robust method overwrites those that have not converged.
#[inline(always)]
fn settle<E: BlockFixedPoint<D>, const D: usize, const NEWTON: bool>(
    equations: &E,
    z: &mut Block<D>,
) {
    let mut settled = Block::zero();
    for p in 0..WIDTH {
        settled.set_path(p, settled_path::<E::Path, D, NEWTON>(&equations.path(p), z.path(p)));
    }
    *z = settled;
}

/// Solves every path that has not converged by the robust method.
#[cold]
#[inline(never)]
fn solve_unfinished<E: BlockFixedPoint<D>, const D: usize>(
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
