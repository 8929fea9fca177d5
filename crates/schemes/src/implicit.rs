//! What the implicit schemes share: the equation z = start + change(start, z), on one path and on a block.

use noise::AreaBlock;
use nonlin::{BlockFixedPoint, BlockStatus, FixedPoint, Method, Solution, Solver};
use real::{Block, Real, VectorFunction, jacobian};
use systems::PoissonSystem;

/// The change over one step of an implicit scheme on systems of type S, driven by noise of type N on each path.
pub(crate) trait Rule<S, N: Copy, const D: usize>: Copy {
    /// The method that solves its equations with the least work.
    const METHOD: Method;

    /// Whether it begins with a long first sweep.
    const LONG_FIRST_SWEEP: bool;

    /// The change from `start` to `z`. Must be `#[inline(always)]`.
    fn change<R: Real>(&self, system: &S, noise: N, start: [f64; D], z: [R; D]) -> [R; D];

    /// A guess of z for `equation`. Must be `#[inline(always)]`.
    #[inline(always)]
    fn predictor(&self, equation: &PathEquation<'_, S, Self, N, D>) -> [f64; D] {
        equation.map(equation.map(equation.start))
    }

    /// The change where z is near the start, NaN where it is not. Must be `#[inline(always)]`.
    #[inline(always)]
    fn change_near(&self, system: &S, noise: N, start: [f64; D], z: [f64; D]) -> [f64; D] {
        self.change(system, noise, start, z)
    }

    /// The same with the Jacobian by z. Must be `#[inline(always)]`.
    #[inline(always)]
    fn jacobian_near(&self, system: &S, noise: N, start: [f64; D], z: [f64; D]) -> ([f64; D], [[f64; D]; D]) {
        jacobian(&Change { rule: *self, system, noise, start }, z)
    }
}

/// The change as a function of z.
struct Change<'a, S, Q, N, const D: usize> {
    rule: Q,
    system: &'a S,
    noise: N,
    start: [f64; D],
}

impl<S, Q: Rule<S, N, D>, N: Copy, const D: usize> VectorFunction<D, D> for Change<'_, S, Q, N, D> {
    #[inline(always)]
    fn value<R: Real>(&self, z: [R; D]) -> [R; D] {
        self.rule.change(self.system, self.noise, self.start, z)
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

/// Whether the steps of a system begin with a long first sweep.
pub(crate) const fn long_first_sweep<S: PoissonSystem<D, M>, const D: usize, const M: usize>() -> bool {
    S::PREFERS_NEWTON || S::SHORT_FIELD
}

impl<S, Q: Rule<S, N, D>, N: Copy, const D: usize> FixedPoint<D> for PathEquation<'_, S, Q, N, D> {
    const METHOD: Method = Q::METHOD;
    const LONG_FIRST_SWEEP: bool = Q::LONG_FIRST_SWEEP;

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
    fn predictor(&self) -> [f64; D] {
        self.rule.predictor(self)
    }

    #[inline(always)]
    fn map_near(&self, z: [f64; D]) -> [f64; D] {
        self.moved(self.rule.change_near(self.system, self.noise, self.start, z))
    }

    #[inline(always)]
    fn jacobian_near(&self, z: [f64; D]) -> ([f64; D], [[f64; D]; D]) {
        let (change, jacobian) = self.rule.jacobian_near(self.system, self.noise, self.start, z);
        (self.moved(change), jacobian)
    }
}

impl<S, Q, N, const D: usize> PathEquation<'_, S, Q, N, D> {
    /// start + change.
    #[inline(always)]
    fn moved(&self, mut change: [f64; D]) -> [f64; D] {
        for i in 0..D {
            change[i] += self.start[i];
        }
        change
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
        PathEquation { rule: self.rule, system: self.system, noise: self.noise.path(p), start: self.start.path(p) }
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
