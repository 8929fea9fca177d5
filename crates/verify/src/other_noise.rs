//! A scheme on other noise than the driver's.

use noise::{BlockNoise, Noise, StepNoise};
use nonlin::{BlockStatus, Solution};
use real::{Block, WIDTH};
use schemes::{Scheme, Step};

/// A scheme on other noise than it is given.
pub struct OtherNoise<'a, S, A, const D: usize, const M: usize> {
    /// The scheme.
    pub scheme: &'a dyn Scheme<S, D, M>,
    /// The noise that path p of a block gets in a step, from that of the block.
    pub noise: A,
}

impl<S, A, const D: usize, const M: usize> Scheme<S, D, M> for OtherNoise<'_, S, A, D, M>
where
    A: Fn(&Step, &BlockNoise<M>, usize) -> Noise<M> + Send + Sync,
{
    fn id(&self) -> &'static str {
        self.scheme.id()
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
        let mut other = StepNoise::with_areas(M);
        (0..WIDTH).for_each(|p| other.set_path(p, &(self.noise)(step, noise, p)));
        self.scheme.step_block(system, step, &(&other).into(), y, status);
    }

    fn step(&self, system: &S, step: &Step, noise: &Noise<M>, y: [f64; D]) -> Solution<D> {
        let mut block = StepNoise::with_areas(M);
        block.set_path(0, noise);
        self.scheme.step(system, step, &(self.noise)(step, &(&block).into(), 0), y)
    }
}
