//! How many steps, paths and repetitions.

use std::collections::BTreeSet;

use analysis::{Mode, Settings, StepSizes, compare::Repetitions};
use noise::StreamKey;
use verify::{
    streams::{WORK_PRECISION, WORK_PRECISION_PARTS},
    truncation,
};

/// What a case is measured with.
pub struct Sizes {
    /// Step sizes of strong errors.
    pub strong: StepSizes,
    /// Step sizes of weak errors.
    pub weak: StepSizes,
    /// Noise of the paths that are timed.
    pub timed: StreamKey,
    /// How often they are timed.
    pub repetitions: Repetitions,
}

impl Sizes {
    /// Of case number `number`, from 1. A reference with Lévy areas draws them at its own step,
    /// which is most of the work, so it is less fine.
    pub fn new(settings: Settings, number: u64, areas: bool) -> Self {
        let first = WORK_PRECISION + WORK_PRECISION_PARTS * number;
        let key = |part| StreamKey { seed: settings.seed, experiment: first + part };
        let sizes = |part, coarsest_steps, levels, refinement, samples| {
            let sizes = StepSizes::new(coarsest_steps, truncation(), key(part));
            StepSizes { levels, refinement, samples, ..sizes }
        };
        let (strong, weak, repetitions) = match settings.mode {
            Mode::Paper => (
                sizes(0, 16, 9, if areas { 3 } else { 4 }, 1024),
                sizes(1, 8, 6, 3, 1 << 15),
                Repetitions { count: 15, path_steps: 1 << 18 },
            ),
            Mode::Quick => (
                sizes(0, 16, 4, 2, 256),
                sizes(1, 8, 3, 2, 2048),
                Repetitions { count: 3, path_steps: 1 << 12 },
            ),
        };
        Self { strong, weak, timed: key(2), repetitions }
    }

    /// Every number of steps whose time is wanted, in increasing order.
    pub fn timed_steps(strong: &StepSizes, weak: &StepSizes) -> Vec<u64> {
        let timed: BTreeSet<u64> = strong.steps().chain(weak.steps()).collect();
        timed.into_iter().collect()
    }
}
