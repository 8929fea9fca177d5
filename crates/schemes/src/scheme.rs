//! What a scheme is.

use noise::AreaBlock;
use nonlin::{BlockStatus, Solution};
use real::Block;

use crate::Step;

/// A one-step method for systems of type S in D dimensions with M noises.
///
/// Increments are given as they are to be used: truncated by the caller where the scheme asks for
/// it. Schemes draw no random number and keep no state.
pub trait Scheme<S, const D: usize, const M: usize>: Send + Sync {
    /// Identifier in results: `sexp`, `em`, `heun`, `midpoint`, `sexp-levy`.
    fn id(&self) -> &'static str;

    /// Advances every path of a block by one step and overwrites `status`. A path that is `failed`
    /// there holds the last iterate, which is no solution.
    fn step_block(
        &self,
        system: &S,
        step: &Step,
        dw: &Block<M>,
        y: &mut Block<D>,
        status: &mut BlockStatus,
    );

    /// Advances one path by one step: the same bits as that path of
    /// [`step_block`](Self::step_block).
    fn step(&self, system: &S, step: &Step, dw: [f64; M], y: [f64; D]) -> Solution<D>;

    /// Whether the scheme reads the Lévy areas of a step. Those who drive it then draw them, which
    /// costs far more than increments do, and call the two methods below.
    fn needs_areas(&self) -> bool {
        false
    }

    /// [`step_block`](Self::step_block) with the Lévy areas of the step, which are ignored unless
    /// [`needs_areas`](Self::needs_areas).
    fn step_block_with_areas(
        &self,
        system: &S,
        step: &Step,
        dw: &Block<M>,
        areas: &AreaBlock<M>,
        y: &mut Block<D>,
        status: &mut BlockStatus,
    ) {
        let _ = areas;
        self.step_block(system, step, dw, y, status);
    }

    /// [`step`](Self::step) with the skew matrix of Lévy areas of the step: the same bits as that
    /// path of [`step_block_with_areas`](Self::step_block_with_areas).
    fn step_with_areas(
        &self,
        system: &S,
        step: &Step,
        dw: [f64; M],
        areas: [[f64; M]; M],
        y: [f64; D],
    ) -> Solution<D> {
        let _ = areas;
        self.step(system, step, dw, y)
    }
}
