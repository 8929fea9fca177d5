//! Schemes with a mistake in what surrounds their formula.

use noise::{BlockNoise, Noise};
use nonlin::{BlockStatus, Outcome, Solution};
use real::{Block, WIDTH};
use schemes::{Scheme, Step};
use systems::Flows;

/// A scheme given by its step of a single path, which reads no areas.
pub struct Pathwise<F> {
    pub advance: F,
    /// Whether the driver clips its increments.
    pub clips: bool,
}

impl<F, S, const D: usize, const M: usize> Scheme<S, D, M> for Pathwise<F>
where
    F: Fn(&S, &Step, &Noise<M>, [f64; D]) -> Solution<D> + Send + Sync,
{
    fn id(&self) -> &'static str {
        "altered"
    }

    fn reads_areas(&self) -> bool {
        false
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
        *status = BlockStatus::explicit();
        for p in 0..WIDTH {
            let solution = self.step(system, step, &noise.path(p), y.path(p));
            y.set_path(p, solution.z);
            status.set(p, solution.outcome);
        }
    }

    fn step(&self, system: &S, step: &Step, noise: &Noise<M>, y: [f64; D]) -> Solution<D> {
        (self.advance)(system, step, noise, y)
    }
}

/// A scheme that gets another step than the right one.
pub fn altered<S, const D: usize, const M: usize>(
    scheme: impl Scheme<S, D, M>,
    other: fn(Step) -> Step,
) -> Pathwise<impl Fn(&S, &Step, &Noise<M>, [f64; D]) -> Solution<D> + Send + Sync> {
    let advance = move |system: &S, step: &Step, noise: &Noise<M>, y| {
        scheme.step(system, &other(*step), noise, y)
    };
    Pathwise { advance, clips: false }
}

/// `split` without the way back: each flow once, for the whole step.
pub fn in_a_row<S: Flows<D, M>, const D: usize, const M: usize>()
-> Pathwise<impl Fn(&S, &Step, &Noise<M>, [f64; D]) -> Solution<D> + Send + Sync> {
    let advance = |system: &S, step: &Step, noise: &Noise<M>, y: [f64; D]| {
        let start = y.map(|component| component * step.first_decay);
        let flow = |y, part| system.flow(part, y, step.tau, noise.increments);
        let end: [f64; D] = (0..S::PARTS).fold(start, flow);
        let z = end.map(|component| component * step.second_decay);
        Solution { z, outcome: Outcome::Fast { iterations: 1 } }
    };
    Pathwise { advance, clips: false }
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
