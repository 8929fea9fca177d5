//! What a scheme is.

use nonlin::{BlockStatus, Solution};
use real::Block;

use crate::Step;

/// A one-step method for systems of type S in D dimensions with M noises.
///
/// Increments are given as they are to be used: truncated by the caller where the scheme asks for it. Schemes draw
/// no random number and keep no state.
pub trait Scheme<S, const D: usize, const M: usize>: Send + Sync {
    /// Identifier in results: `sexp`, `em`, `midpoint`.
    fn id(&self) -> &'static str;

    /// Advances every path of a block by one step and overwrites `status`. A path that is `failed` there holds the
    /// last iterate, which is no solution.
    fn step_block(&self, system: &S, step: &Step, dw: &Block<M>, y: &mut Block<D>, status: &mut BlockStatus);

    /// Advances one path by one step: the same bits as that path of [`step_block`](Self::step_block).
    fn step(&self, system: &S, step: &Step, dw: [f64; M], y: [f64; D]) -> Solution<D>;
}
