//! Schemes with a mistake in what surrounds their formula.

use noise::{BlockNoise, Noise};
use nonlin::{BlockStatus, Outcome, Solution};
use real::{Block, WIDTH};
use schemes::{Scheme, Step};
use systems::Flows;

/// A scheme with a wrong damping or wrong clipping.
pub struct Altered<S> {
    /// The right scheme.
    pub scheme: S,
    /// The step that it gets for the right one.
    pub step: fn(Step) -> Step,
    /// Whether the driver clips its increments.
    pub clips: bool,
}

/// With all of the damping before the rest of the step.
pub fn damped_before(step: Step) -> Step {
    damped(step, [step.first_decay * step.second_decay, 1.0])
}

/// With all of the damping after the rest of the step.
pub fn damped_after(step: Step) -> Step {
    damped(step, [1.0, step.first_decay * step.second_decay])
}

/// With the damping of the first half for both halves.
pub fn damped_by_first_half(step: Step) -> Step {
    damped(step, [step.first_decay; 2])
}

fn damped(mut step: Step, decays: [f64; 2]) -> Step {
    [step.first_decay, step.second_decay] = decays;
    step
}

impl<C: Scheme<S, D, M>, S, const D: usize, const M: usize> Scheme<S, D, M> for Altered<C> {
    fn id(&self) -> &'static str {
        self.scheme.id()
    }

    fn reads_areas(&self) -> bool {
        self.scheme.reads_areas()
    }

    fn clips_increments(&self) -> bool {
        self.clips
    }

    fn step_block(
        &self,
        system: &S,
        step: &Step,
        noise: &BlockNoise<M>,
        y: &mut Block<D>,
        status: &mut BlockStatus,
    ) {
        self.scheme.step_block(system, &(self.step)(*step), noise, y, status);
    }

    fn step(&self, system: &S, step: &Step, noise: &Noise<M>, y: [f64; D]) -> Solution<D> {
        self.scheme.step(system, &(self.step)(*step), noise, y)
    }
}

/// `split` without the way back: each flow once, for the whole step.
pub struct InARow;

impl<S: Flows<D, M>, const D: usize, const M: usize> Scheme<S, D, M> for InARow {
    fn id(&self) -> &'static str {
        "split, in a row"
    }

    fn reads_areas(&self) -> bool {
        false
    }

    fn clips_increments(&self) -> bool {
        false
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
            let path = Noise::increments(noise.increments_of(p));
            y.set_path(p, self.step(system, step, &path, y.path(p)).z);
        }
        *status = BlockStatus::explicit();
    }

    fn step(&self, system: &S, step: &Step, noise: &Noise<M>, y: [f64; D]) -> Solution<D> {
        let start = y.map(|component| component * step.first_decay);
        let flow = |y, part| system.flow(part, y, step.tau, noise.increments);
        let end: [f64; D] = (0..S::PARTS).fold(start, flow);
        let z = end.map(|component| component * step.second_decay);
        Solution { z, outcome: Outcome::Fast { iterations: 1 } }
    }
}
