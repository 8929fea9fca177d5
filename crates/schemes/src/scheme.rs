//! A scheme on a system, as whoever drives it sees it.

use noise::{BlockNoise, Noise};
use nonlin::{BlockStatus, Solution};
use real::Block;

use crate::Step;

/// A one-step method for systems of type S in D dimensions with M noises.
///
/// Every formula that is [`Explicit`](crate::Explicit) or [`Implicit`](crate::Implicit) is a scheme
/// for every [`PoissonSystem`](systems::PoissonSystem); only what is no formula on one path
/// implements this trait itself. Schemes draw no random number, truncate nothing and keep no state.
pub trait Scheme<S, const D: usize, const M: usize>: Send + Sync {
    /// Identifier in results: `sexp`, `em`, `heun`, `midpoint`, `sexp-levy`.
    fn id(&self) -> &'static str;

    /// Whether the scheme reads the Lévy areas of a step. Whoever drives it then draws them.
    fn reads_areas(&self) -> bool;

    /// Whether whoever drives the scheme truncates increments and areas.
    fn clips_increments(&self) -> bool;

    /// Advances every path of a block by one step and overwrites `status`. A path that is `failed`
    /// there holds the last iterate, which is no solution.
    fn step_block(
        &self,
        system: &S,
        step: &Step,
        noise: &BlockNoise<M>,
        y: &mut Block<D>,
        status: &mut BlockStatus,
    );

    /// Advances one path by one step: the same bits as that path of
    /// [`step_block`](Self::step_block).
    fn step(&self, system: &S, step: &Step, noise: &Noise<M>, y: [f64; D]) -> Solution<D>;
}
