//! Schemes on systems, as drivers see them.

use noise::StepNoise;
use nonlin::BlockStatus;
use real::{PathMask, Row};

use crate::{Listing, Step};

/// Identifier of a scheme or a method, and what it needs of a driver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct About {
    /// Identifier in results, for example `sexp`.
    pub id: &'static str,
    /// Whether it reads the Lévy areas of a step. If so, the driver draws them.
    pub reads_areas: bool,
    /// Whether it reads the space-time areas of a step. If so, the driver draws them.
    pub reads_space_time: bool,
    /// Whether the driver truncates increments and areas for it.
    pub clips_increments: bool,
    /// Bytes of stack that a step needs, if not few.
    pub stack: usize,
}

impl About {
    /// A method that reads no areas, takes increments of any size, and needs little stack.
    pub const fn new(id: &'static str) -> Self {
        Self { id, reads_areas: false, reads_space_time: false, clips_increments: false, stack: 0 }
    }
}

/// A scheme on a system, both fixed, of any dimension and with any number of noises: what a driver
/// sees of them.
///
/// A [`Scheme`](crate::Scheme) on a [`PoissonSystem`](systems::PoissonSystem) becomes one in `mc`,
/// and so does a scheme on a system known at run time. Like a scheme it draws no random numbers and
/// truncates nothing.
pub trait Method: Send + Sync {
    /// Identifier, and what the method needs of a driver.
    fn about(&self) -> About;

    /// Zero noise of a step, with the areas that the method reads.
    fn no_noise(&self, noises: usize) -> StepNoise {
        let About { reads_areas, reads_space_time, .. } = self.about();
        let none = StepNoise::none(noises, reads_areas);
        if reads_space_time { none.with_space_time() } else { none }
    }

    /// 32 paths in the states `y`; row i is component i. A block of paths has one for each run,
    /// made once.
    fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_>;
}

/// The state of 32 paths, or of one large path, that advances step by step.
pub trait Stepper: Send {
    /// The rows of the state.
    fn state(&self) -> &[Row];

    /// The rows of the state, to be set.
    fn state_mut(&mut self) -> &mut [Row];

    /// Advances by one step and overwrites `status`. A path that `status` marks as failed may hold
    /// anything. Of one large path, `status` has that of path 0.
    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus);

    /// Takes the paths `live`, which alone are wanted from here on. Returns whether none of them
    /// moves any more, such as after an event that stops them: further steps then read no noise.
    fn rests(&mut self, _live: PathMask) -> bool {
        false
    }

    /// The step as a program; none if it is not made of one.
    fn listing(&mut self, _step: &Step) -> Option<Listing<'_>> {
        None
    }
}
