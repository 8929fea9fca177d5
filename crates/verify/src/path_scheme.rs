//! A scheme written for one path.

use noise::{BlockNoise, Noise};
use nonlin::{BlockStatus, Outcome, Solution};
use real::{Block, WIDTH};
use schemes::{Scheme, Step};

/// A scheme given as a function (system, step, increments, y_n) ↦ y_{n+1}: slower than a block
/// kernel, and all that is needed to put a new method, or a wrong one, to the test.
#[derive(Clone, Copy, Debug)]
pub struct PathScheme<F> {
    /// Identifier in results.
    pub id: &'static str,
    /// The step.
    pub advance: F,
}

impl<F, S, const D: usize, const M: usize> Scheme<S, D, M> for PathScheme<F>
where
    F: Fn(&S, &Step, [f64; M], [f64; D]) -> [f64; D] + Send + Sync,
{
    fn id(&self) -> &'static str {
        self.id
    }

    fn reads_areas(&self) -> bool {
        false
    }

    fn clips_increments(&self) -> bool {
        true
    }

    fn step_block(
        &self,
        system: &S,
        step: &Step,
        noise: &BlockNoise<M>,
        y: &mut Block<D>,
        status: &mut BlockStatus,
    ) {
        for p in 0..WIDTH {
            let dw = noise.increments.path(p);
            y.set_path(p, (self.advance)(system, step, dw, y.path(p)));
        }
        *status = BlockStatus::explicit();
    }

    fn step(&self, system: &S, step: &Step, noise: &Noise<M>, y: [f64; D]) -> Solution<D> {
        let z = (self.advance)(system, step, noise.increments, y);
        Solution { z, outcome: Outcome::Fast { iterations: 1 } }
    }
}
