//! What the implicit schemes share: the equation z = start + change(start, z), on one path and on a
//! block.

use noise::AreaBlock;
use nonlin::{BlockFixedPoint, BlockStatus, FirstSweep, FixedPoint, Method, Solution, Solver};
use real::{Block, Real};
use systems::PoissonSystem;

/// The change over one step of an implicit scheme on systems of type S, driven by noise of type N
/// on each path.
pub(crate) trait Rule<S, N: Copy, const D: usize>: Copy {
    /// The method that solves its equations with the least work.
    const METHOD: Method;

    /// How it begins.
    const FIRST_SWEEP: FirstSweep;

    /// The change from `start` to `z`. Must be `#[inline(always)]`.
    fn change<R: Real>(&self, system: &S, noise: N, start: [f64; D], z: [R; D]) -> [R; D];

    /// The solution from `start` and a bound of its residual, for [`FirstSweep::Own`]. Must be
    /// `#[inline(always)]`.
    #[inline(always)]
    fn own_sweep(&self, system: &S, noise: N, start: [f64; D]) -> ([f64; D], f64) {
        let _ = (system, noise);
        (start, f64::INFINITY)
    }

    /// The same of two paths, which may be taken in turn. Must be `#[inline(always)]`.
    #[inline(always)]
    fn own_sweeps(&self, system: &S, noise: [N; 2], start: [[f64; D]; 2]) -> [([f64; D], f64); 2] {
        [self.own_sweep(system, noise[0], start[0]), self.own_sweep(system, noise[1], start[1])]
    }
}

/// What a block of paths sees of the noise over a step.
pub(crate) trait BlockNoise {
    /// What one path sees.
    type Path: Copy;
    /// What path `p` sees. Must be `#[inline(always)]`.
    fn path(&self, p: usize) -> Self::Path;
}

impl<const M: usize> BlockNoise for Block<M> {
    type Path = [f64; M];
    #[inline(always)]
    fn path(&self, p: usize) -> [f64; M] {
        self.path(p)
    }
}

/// Increments and Lévy areas of one path.
#[derive(Clone, Copy)]
pub(crate) struct WithAreas<const M: usize> {
    pub(crate) dw: [f64; M],
    pub(crate) areas: [[f64; M]; M],
}

/// Increments and Lévy areas of a block.
pub(crate) struct BlockWithAreas<'a, const M: usize> {
    pub(crate) dw: &'a Block<M>,
    pub(crate) areas: &'a AreaBlock<M>,
}

impl<const M: usize> BlockNoise for BlockWithAreas<'_, M> {
    type Path = WithAreas<M>;
    #[inline(always)]
    fn path(&self, p: usize) -> WithAreas<M> {
        WithAreas { dw: self.dw.path(p), areas: self.areas.path(p) }
    }
}

/// The equation of one path.
pub(crate) struct PathEquation<'a, S, Q, N, const D: usize> {
    rule: Q,
    pub(crate) system: &'a S,
    pub(crate) noise: N,
    pub(crate) start: [f64; D],
}

impl<S, Q: Copy, N: Copy, const D: usize> Clone for PathEquation<'_, S, Q, N, D> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}
impl<S, Q: Copy, N: Copy, const D: usize> Copy for PathEquation<'_, S, Q, N, D> {}

/// The method for the steps of a system.
pub(crate) const fn method<S: PoissonSystem<D, M>, const D: usize, const M: usize>() -> Method {
    if S::PREFERS_NEWTON { Method::Newton } else { Method::FixedPoint }
}

/// How the steps of a system begin where it cannot solve them itself.
pub(crate) const fn first_sweep<S: PoissonSystem<D, M>, const D: usize, const M: usize>()
-> FirstSweep {
    if S::PREFERS_NEWTON || S::SHORT_FIELD { FirstSweep::Long } else { FirstSweep::Plain }
}

impl<S, Q: Rule<S, N, D>, N: Copy, const D: usize> FixedPoint<D> for PathEquation<'_, S, Q, N, D> {
    const METHOD: Method = Q::METHOD;
    const FIRST_SWEEP: FirstSweep = Q::FIRST_SWEEP;

    #[inline(always)]
    fn start(&self) -> [f64; D] {
        self.start
    }

    #[inline(always)]
    fn map<R: Real>(&self, z: [R; D]) -> [R; D] {
        let mut next = self.rule.change(self.system, self.noise, self.start, z);
        for i in 0..D {
            next[i] = next[i] + self.start[i];
        }
        next
    }

    #[inline(always)]
    fn own_sweep(&self) -> ([f64; D], f64) {
        self.rule.own_sweep(self.system, self.noise, self.start)
    }

    #[inline(always)]
    fn own_sweeps(one: &Self, other: &Self) -> [([f64; D], f64); 2] {
        one.rule.own_sweeps(one.system, [one.noise, other.noise], [one.start, other.start])
    }
}

/// The equations of a block.
struct BlockEquation<'a, S, Q, B, const D: usize> {
    rule: Q,
    system: &'a S,
    noise: &'a B,
    start: &'a Block<D>,
}

impl<'a, S, Q: Rule<S, B::Path, D>, B: BlockNoise, const D: usize> BlockFixedPoint<D>
    for BlockEquation<'a, S, Q, B, D>
{
    type Path = PathEquation<'a, S, Q, B::Path, D>;
    #[inline(always)]
    fn path(&self, p: usize) -> Self::Path {
        PathEquation {
            rule: self.rule,
            system: self.system,
            noise: self.noise.path(p),
            start: self.start.path(p),
        }
    }
}

/// Solves the equations of a block; to be called inside a kernel.
#[inline(always)]
pub(crate) fn solve_block<S, Q: Rule<S, B::Path, D>, B: BlockNoise, const D: usize>(
    solver: &Solver,
    rule: Q,
    system: &S,
    noise: &B,
    start: &Block<D>,
    status: &mut BlockStatus,
) -> Block<D> {
    let mut z = Block::zero();
    solver.solve_block(&BlockEquation { rule, system, noise, start }, &mut z, status);
    z
}

/// Solves the equation of one path.
pub(crate) fn solve_path<S, Q: Rule<S, N, D>, N: Copy, const D: usize>(
    solver: &Solver,
    rule: Q,
    system: &S,
    noise: N,
    start: [f64; D],
) -> Solution<D> {
    solver.solve(&PathEquation { rule, system, noise, start })
}
