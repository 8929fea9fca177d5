//! Single steps of a scheme, 32 at once.

use mc::Setup;
use noise::StepNoise;
use nonlin::BlockStatus;
use real::{PathMask, Row, WIDTH};
use schemes::{Step, Stepper};

use super::runs::Visit;

/// Steps from one state on 32 noises. Lanes that nobody sets have none.
pub struct Steps<'a> {
    /// What is stepped.
    pub setup: &'a Setup<'a>,
    /// The noise of a step, or of the two halves of one.
    pub noises: [StepNoise; 2],
    /// No noise, and that of both halves.
    zero: StepNoise,
    both: StepNoise,
    state: Box<dyn Stepper + 'a>,
    /// The ends of whole steps.
    one: Vec<Row>,
}

/// The ends of one step and of two half steps on the same noise, on the paths whose steps succeed.
pub struct OneAndTwo<'a> {
    pub one: &'a [Row],
    pub two: &'a [Row],
    pub live: PathMask,
}

impl<'a> Steps<'a> {
    pub fn new(setup: &'a Setup<'a>) -> Self {
        let start = setup.start();
        let none = || setup.scheme.no_noise(setup.problem.noises);
        Self {
            noises: [none(), none()],
            zero: none(),
            both: none(),
            state: setup.scheme.start(&start[..setup.problem.y0.len()]),
            one: start,
            setup,
        }
    }

    /// Sets these paths to a state.
    fn set(&mut self, state: &[f64], paths: PathMask) {
        for (row, &y) in self.state.state_mut().iter_mut().zip(state) {
            paths.paths().for_each(|p| row[p] = y);
        }
    }

    /// The ends of steps from `state` on the first `count` of the first noises, on the paths whose
    /// steps succeed.
    pub fn step(&mut self, step: &Step, state: &[f64], count: usize) -> (&[Row], PathMask) {
        self.take_noise(PathMask::ALL.without(PathMask::first(count)));
        self.set(state, PathMask::ALL);
        let mut status = BlockStatus::explicit();
        self.state.step(step, &self.noises[0], &mut status);
        (self.state.state(), PathMask::first(count).without(status.failed))
    }

    /// Takes the noise from paths that nobody asks for, or no more.
    fn take_noise(&mut self, paths: PathMask) {
        let Self { noises, zero, .. } = self;
        noises.iter_mut().for_each(|n| paths.paths().for_each(|p| n.copy_path(p, zero, p)));
    }

    /// A step τ from the visit and two half steps, on the first `count` of the noises; `None` if
    /// there is no such step.
    pub fn one_and_two(&mut self, visit: &Visit, tau: f64, count: usize) -> Option<OneAndTwo<'_>> {
        self.take_noise(PathMask::ALL.without(PathMask::first(count)));
        // Times are multiples of the step size.
        let n = (visit.t / tau).round() as u64;
        let damping = self.setup.problem.damping;
        let step = |n: u64, tau: f64| Step::new(damping, n, tau).ok();
        let (whole, first) = (step(n, tau)?, step(2 * n, 0.5 * tau)?);
        let second = step(2 * n + 1, 0.5 * tau)?;
        (0..WIDTH).for_each(|p| self.both.copy_path(p, &self.noises[0], p));
        self.both.join(&self.noises[1]);
        let (mut live, mut status) = (PathMask::first(count), BlockStatus::explicit());
        self.set(&visit.state, PathMask::ALL);
        self.state.step(&whole, &self.both, &mut status);
        self.one.copy_from_slice(self.state.state());
        self.set(&visit.state, PathMask::ALL);
        for (k, half) in [first, second].iter().enumerate() {
            live = live.without(status.failed);
            // More steps of a path that failed, which may hold anything, would only cost time.
            self.take_noise(status.failed);
            self.set(&visit.state, status.failed);
            self.state.step(half, &self.noises[k], &mut status);
        }
        live = live.without(status.failed);
        Some(OneAndTwo { one: &self.one, two: self.state.state(), live })
    }
}
