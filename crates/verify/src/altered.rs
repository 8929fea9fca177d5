//! Methods on another step or other increments than they are given.

use std::sync::Arc;

use mc::Setup;
use noise::StepNoise;
use nonlin::BlockStatus;
use real::Row;
use schemes::{Method, Step, Stepper};

/// A method without areas that gets another step, and multiples of the increments.
pub struct Altered<'a> {
    /// The method.
    pub method: Arc<dyn Method + 'a>,
    /// The step that it gets in the place of a step.
    pub step: fn(Step) -> Step,
    /// What increments are multiplied by, after they were clipped.
    pub factor: f64,
    /// Whether they are clipped.
    pub clips: bool,
}

impl<'a> Altered<'a> {
    /// A set-up whose method is altered by `alter`, which is given one that is as it was.
    pub fn setup(setup: Setup<'a>, alter: impl FnOnce(&mut Self)) -> Setup<'a> {
        let (method, clips) = (setup.scheme.clone(), setup.scheme.clips_increments());
        let mut altered = Self { method, step: |step| step, factor: 1.0, clips };
        alter(&mut altered);
        Setup { scheme: Arc::new(altered), ..setup }
    }
}

impl Method for Altered<'_> {
    fn id(&self) -> &'static str {
        self.method.id()
    }

    fn reads_areas(&self) -> bool {
        false
    }

    fn clips_increments(&self) -> bool {
        self.clips
    }

    fn stack(&self) -> usize {
        self.method.stack()
    }

    fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_> {
        Box::new(AlteredStepper { stepper: self.method.start(y), altered: self })
    }
}

struct AlteredStepper<'a> {
    stepper: Box<dyn Stepper + 'a>,
    altered: &'a Altered<'a>,
}

impl Stepper for AlteredStepper<'_> {
    fn state(&self) -> &[Row] {
        self.stepper.state()
    }

    fn state_mut(&mut self) -> &mut [Row] {
        self.stepper.state_mut()
    }

    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        let mut other = StepNoise::zero(noise.increments.len());
        for (other, row) in other.increments.iter_mut().zip(noise.increments.iter()) {
            *other = row.map(|dw| self.altered.factor * dw);
        }
        self.stepper.step(&(self.altered.step)(*step), &other, status);
    }
}
