//! Schemes with a mistake in what surrounds their formula.

use schemes::{Composition, Paths, Step, Times};
use systems::Flows;

/// `split` without the way back: each flow once, for the whole step.
pub struct InARow;

impl<S: Flows<D, M>, const D: usize, const M: usize> Composition<S, D, M> for InARow {
    const ID: &'static str = "split, in a row";

    #[inline(always)]
    fn compose<const N: usize>(&self, step: &Step, paths: &mut Paths<'_, S, D, M, N>) {
        paths.scale(step.first_decay);
        (0..S::PARTS).for_each(|part| paths.flow(part, Times::step(step)));
        paths.scale(step.second_decay);
    }
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
