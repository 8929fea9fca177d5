//! Methods on another step or other noise than they are given.

use std::sync::Arc;

use nonlin::BlockStatus;
use schemes::{About, Method, Stepper};

use crate::*;

/// Change of a step and its noise, applied after increments were clipped.
type Change<'a> = dyn Fn(&mut Step, &mut StepNoise) + Send + Sync + 'a;

/// Method that runs on a changed step or changed noise.
struct Altered<'a> {
    method: Arc<dyn Method + 'a>,
    about: About,
    change: Box<Change<'a>>,
}

/// Alters a set-up: its method gets each step and noise after `change`. Increments are clipped
/// first if the method clips them, or if `clips` is set.
pub fn altered<'a>(
    setup: Setup<'a>,
    clips: bool,
    change: impl Fn(&mut Step, &mut StepNoise) + Send + Sync + 'a,
) -> Setup<'a> {
    let method = setup.scheme;
    let mut about = method.about();
    about.clips_increments |= clips;
    let scheme = Arc::new(Altered { method, about, change: Box::new(change) });
    Setup { scheme, ..setup }
}

impl Method for Altered<'_> {
    fn about(&self) -> About {
        self.about
    }

    fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_> {
        Box::new(AlteredStepper(self.method.start(y), &*self.change))
    }
}

struct AlteredStepper<'a>(Box<dyn Stepper + 'a>, &'a Change<'a>);

impl Stepper for AlteredStepper<'_> {
    fn state(&self) -> &[Row] {
        self.0.state()
    }

    fn state_mut(&mut self) -> &mut [Row] {
        self.0.state_mut()
    }

    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        let (mut step, mut other) = (*step, noise.clone());
        (self.1)(&mut step, &mut other);
        self.0.step(&step, &other, status);
    }
}
