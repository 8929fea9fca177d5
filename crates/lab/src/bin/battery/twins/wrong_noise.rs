//! A right scheme on the wrong noise.

use noise::{BlockNoise, Noise};
use nonlin::{BlockStatus, Solution};
use real::{Block, WIDTH};
use schemes::{Scheme, Step};

/// `scheme` on other noise than it is given.
pub struct WrongNoise<F, A> {
    /// The scheme.
    pub scheme: F,
    /// The noise that path p of a block gets.
    pub noise: A,
}

impl<F, A, S, const D: usize, const M: usize> Scheme<S, D, M> for WrongNoise<F, A>
where
    F: Scheme<S, D, M>,
    A: Fn(&Step, &BlockNoise<M>, usize) -> Noise<M> + Send + Sync,
{
    fn id(&self) -> &'static str {
        "wrong noise"
    }

    fn reads_areas(&self) -> bool {
        self.scheme.reads_areas()
    }

    fn clips_increments(&self) -> bool {
        self.scheme.clips_increments()
    }

    fn step_block(
        &self,
        system: &S,
        step: &Step,
        noise: &BlockNoise<M>,
        y: &mut Block<D>,
        status: &mut BlockStatus,
    ) {
        let mut wrong = BlockNoise::zero();
        for p in 0..WIDTH {
            let Noise { increments, areas } = (self.noise)(step, noise, p);
            wrong.increments.set_path(p, increments);
            wrong.areas.set_path(p, areas);
        }
        self.scheme.step_block(system, step, &wrong, y, status);
    }

    fn step(&self, system: &S, step: &Step, noise: &Noise<M>, y: [f64; D]) -> Solution<D> {
        let mut block = BlockNoise::zero();
        block.increments.set_path(0, noise.increments);
        block.areas.set_path(0, noise.areas);
        self.scheme.step(system, step, &(self.noise)(step, &block, 0), y)
    }
}
