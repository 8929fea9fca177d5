//! The trait of one-step methods.

use noise::{BlockNoise, Noise};
use nonlin::{BlockStatus, Solution};
use real::Block;

use crate::{About, Step};

/// A one-step method for systems of type S in D dimensions with M noises.
///
/// Every [`Explicit`](crate::Explicit) or [`Implicit`](crate::Implicit) formula is a scheme for
/// every [`PoissonSystem`](systems::PoissonSystem). Implement this trait directly only if a method
/// is not one formula on one path. Schemes draw no random numbers, truncate nothing and have no
/// state.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a scheme for `{S}`",
    note = "implement `Explicit`, `Implicit` or, for a system with `Flows`, `Composition`"
)]
pub trait Scheme<S, const D: usize, const M: usize>: Send + Sync {
    /// Identifier, and what the scheme needs of a driver.
    fn about(&self) -> About;

    /// Advances every path of the block `y` by one step and overwrites `status`. A path that
    /// `status` marks as failed holds the last iterate of the solver, which is not a solution.
    fn step_block(
        &self,
        system: &S,
        step: &Step,
        noise: &BlockNoise<M>,
        y: &mut Block<D>,
        status: &mut BlockStatus,
    );

    /// Advances one path by one step, with the same bits as [`step_block`](Self::step_block).
    fn step(&self, system: &S, step: &Step, noise: &Noise<M>, y: [f64; D]) -> Solution<D>;

    /// The scheme with its noises in their order and in the opposite one, if the mean of both has
    /// an expansion of its weak error in even powers of τ.
    fn both_orders(&self) -> Option<[Box<dyn Scheme<S, D, M>>; 2]> {
        None
    }
}
