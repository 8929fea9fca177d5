//! How many steps, paths and repetitions.

use lab::streams::{WORK_PRECISION, WORK_PRECISION_PARTS};
use lab::truncation;
use noise::StreamKey;
use verify::work_precision::{Repetitions, steps};
use verify::{Mode, Settings, StepSizes};

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
        let key = |part| StreamKey {
            seed: settings.seed,
            experiment: WORK_PRECISION + WORK_PRECISION_PARTS * number + part,
        };
        let sizes = |coarsest_steps, levels, refinement, samples, part| StepSizes {
            coarsest_steps,
            levels,
            refinement,
            samples,
            truncation: truncation(),
            key: key(part),
        };
        let (strong, weak, repetitions) = match settings.mode {
            Mode::Paper => (
                sizes(16, 9, if areas { 3 } else { 4 }, 1024, 0),
                sizes(8, 6, 3, 1 << 15, 1),
                Repetitions { count: 15, path_steps: 1 << 18 },
            ),
            Mode::Quick => (
                sizes(16, 4, 2, 256, 0),
                sizes(8, 3, 2, 2048, 1),
                Repetitions { count: 3, path_steps: 1 << 12 },
            ),
        };
        Self { strong, weak, timed: key(2), repetitions }
    }

    /// Every number of steps whose time is wanted, in increasing order.
    pub fn timed_steps(&self) -> Vec<u64> {
        let mut timed: Vec<u64> = steps(&self.strong).chain(steps(&self.weak)).collect();
        timed.sort_unstable();
        timed.dedup();
        timed
    }
}

/// Steps of the reference.
pub fn reference_steps(sizes: &StepSizes) -> u64 {
    sizes.coarsest_steps << (sizes.levels - 1 + sizes.refinement as usize)
}
