//! One path of a system with very many components.

use mc::{Cause, Checkpoint, LadderError, PathFailure, parts::JobError};
use noise::{Purpose, StepNoise, StreamKey, Truncation, WienerPath, WienerRows};
use nonlin::BlockStatus;
use rayon::prelude::*;
use real::{Row, Rows, WIDTH};
use schemes::{
    Step, Stepper,
    run_time::{Scheme, SchemeError},
};
use serde::{Deserialize, Serialize};
use systems::{
    Damping,
    run_time::{Description, Lanes, Problem, System},
};

/// One path of a system whose rows hold one path, such as a lattice of a million spins. A step uses
/// all threads of the current rayon pool, and its bits do not depend on their number. Memory is a
/// few states.
///
/// Noise that is common to all components is that of the path of this number in any other
/// simulation. Local noise has streams of its own for each tile of the system.
///
/// ```
/// use std::sync::Arc;
/// use lattice::LargePath;
/// use noise::{StreamKey, Truncation};
/// use schemes::SexpLi;
/// use systems::{Constant, lattice::{Couplings, Shape, SpinLattice}, run_time::Problem};
///
/// let couplings = Couplings { exchange: 1.0, noise: 0.3, local: true, ..Couplings::default() };
/// let lattice = SpinLattice::one_path(Shape::periodic(&[20, 20, 20])?, couplings)?;
/// let scheme = SexpLi::at_run_time(&lattice)?;
/// let (lattice, y0) = (Arc::new(lattice), [0.0, 0.0, 1.0].repeat(8000));
/// let problem = Problem::new(lattice, Arc::new(Constant::new(0.0)?), y0, 1.0)?;
/// let key = StreamKey { seed: 1, experiment: 0 };
/// let mut path = LargePath::new(&problem, &scheme, 100, Truncation::new(4)?, key, 0)?;
/// while path.steps_done() < 100 {
///     path.advance(10)?;
///     let of = |spin: usize, i: usize| path.component(3 * spin + i);
///     let square = |spin| (0..3).map(|i| of(spin, i).powi(2)).sum::<f64>();
///     assert!((0..8000).all(|spin| (square(spin).sqrt() - 1.0).abs() < 1e-13));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct LargePath<'a> {
    system: &'a dyn System,
    damping: &'a dyn Damping,
    stepper: Box<dyn Stepper + 'a>,
    source: Source,
    noise: StepNoise,
    /// Bound at which increments are clipped.
    bound: f64,
    tau: f64,
    done: u64,
    /// Description of a failure, except its step and cause.
    failure: PathFailure,
    checkpoint: Option<&'a Checkpoint>,
}

/// The work on a path so far, as a checkpoint has it.
#[derive(Serialize, Deserialize)]
pub struct Work {
    done: u64,
    rows: Vec<Row>,
    source: Source,
}

/// The source of increments.
#[derive(Clone, Serialize, Deserialize)]
enum Source {
    /// One stream, whose normals are the same for all components.
    Common(WienerPath<1>),
    /// Streams for every tile.
    Local(Vec<WienerRows>),
}

/// Number of steps between two checks that the state is finite.
const CHECKED: u64 = 64;

impl<'a> LargePath<'a> {
    /// Path number `path` of a problem in `steps` steps on [0, T].
    ///
    /// # Errors
    /// [`LadderError`] if rows of the system hold 32 paths, there are no steps, the scheme is not
    /// for the system, the truncation is undefined at T/steps, or an allocation failed.
    pub fn new(
        problem: &'a Problem,
        scheme: &'a dyn Scheme,
        steps: u64,
        truncation: Truncation,
        key: StreamKey,
        path: u64,
    ) -> Result<Self, LadderError> {
        let key = key.paths_of(Purpose::Paths)?;
        let (system, damping) = (problem.system(), problem.damping());
        let Description { name, layout, .. } = system.description();
        if layout.lanes == Lanes::Paths {
            let message = format!(
                "rows of `{name}` hold 32 paths: take an ensemble, or a layout for one path"
            );
            return Err(SchemeError(message).into());
        }
        if steps == 0 {
            return Err(LadderError::Steps { steps, multiple_of: 1 });
        }
        let tau = problem.t_end() / steps as f64;
        Step::new(damping, 0, tau)?;
        let clips = scheme.about().clips_increments;
        let bound = if clips { truncation.bound(tau)? } else { f64::INFINITY };
        let mut stepper = scheme.stepper(system)?;
        for (component, &y) in problem.y0().iter().enumerate() {
            let (row, place) = layout.place(component);
            stepper.state_mut()[row][place] = y;
        }
        let tiles = layout.rows.div_ceil(layout.tile_rows) as u64;
        let source = if layout.local_noise {
            let key = key.of_tiles(path);
            let streams = |tile| WienerRows::new(key, tile * WIDTH as u64);
            Source::Local((0..tiles).map(streams).collect())
        } else {
            Source::Common(WienerPath::new(key, path))
        };
        let noise = Rows::zero(layout.noise_rows).into();
        let (scheme, cause) = (scheme.about().id, Cause::NotFinite);
        let failure = PathFailure { path, key, scheme, swapped: false, tau, step: 0, cause };
        Ok(Self {
            system,
            damping,
            stepper,
            source,
            noise,
            bound,
            tau,
            done: 0,
            failure,
            checkpoint: None,
        })
    }

    /// Resumes the path from a file, with the same bits, and writes it there now and then while it
    /// advances. The file stays at the end.
    ///
    /// # Errors
    /// [`JobError`] if the file cannot be read, is damaged or is of another path.
    pub fn keeping(mut self, checkpoint: &'a Checkpoint) -> Result<Self, JobError> {
        if let Some(work) = checkpoint.read()? {
            self.resume(work).map_err(JobError::Refused)?;
        }
        Ok(Self { checkpoint: Some(checkpoint), ..self })
    }

    /// The work so far, in the form of [`Work`].
    pub fn work(&self) -> impl Serialize + '_ {
        (self.done, self.stepper.state(), &self.source)
    }

    /// Goes on from the work of this path, with the same bits.
    ///
    /// # Errors
    /// A sentence, if the work is of another system.
    pub fn resume(&mut self, Work { done, rows, source }: Work) -> Result<(), String> {
        let state = self.stepper.state_mut();
        if rows.len() != state.len() {
            let [found, here] = [rows.len(), state.len()];
            return Err(format!("the work is a state of {found} rows, and here are {here}"));
        }
        state.copy_from_slice(&rows);
        (self.done, self.source) = (done, source);
        Ok(())
    }

    /// Writes the checkpoint, if there is a file for it. [`Checkpoint::failure`] says why that
    /// failed.
    pub fn keep(&self) {
        if let Some(checkpoint) = self.checkpoint {
            _ = checkpoint.write(&self.work());
        }
    }

    /// Advances by `steps` steps, also beyond T.
    ///
    /// # Errors
    /// The failure of a step. A state that is not finite is found within 64 steps.
    pub fn advance(&mut self, steps: u64) -> Result<(), PathFailure> {
        let mut status = BlockStatus::explicit();
        for n in 1..=steps {
            // The size of a step was checked when the path was made.
            let step = Step::new(self.damping, self.done, self.tau)
                .unwrap_or_else(|error| unreachable!("{error}"));
            self.draw();
            self.stepper.step(&step, &self.noise, &mut status);
            let failed = |cause| Err(PathFailure { step: self.done, cause, ..self.failure });
            if !status.failed.is_empty() {
                return failed(Cause::of_residual(status.residual(0)));
            }
            if (n % CHECKED == 0 || n == steps) && !self.is_finite() {
                return failed(Cause::NotFinite);
            }
            self.done += 1;
            if self.checkpoint.is_some_and(Checkpoint::is_due) {
                self.keep();
            }
        }
        Ok(())
    }

    /// Draws the increments of the next step.
    fn draw(&mut self) {
        let (sqrt_tau, bound) = (self.tau.sqrt(), self.bound);
        match &mut self.source {
            Source::Common(stream) => {
                for row in self.noise.increments.iter_mut() {
                    *row = [(stream.normal() * sqrt_tau).clamp(-bound, bound); WIDTH];
                }
            }
            Source::Local(streams) => {
                let tile_rows = self.system.description().layout.tile_rows;
                let tiles = self.noise.increments.par_chunks_mut(tile_rows);
                tiles.zip(streams).for_each(|(dw, stream)| {
                    stream.increments(sqrt_tau, dw);
                    if bound < f64::INFINITY {
                        dw.iter_mut().flatten().for_each(|dw| *dw = dw.clamp(-bound, bound));
                    }
                });
            }
        }
    }

    fn is_finite(&self) -> bool {
        self.state().par_chunks(1024).all(|rows| rows.as_flattened().iter().all(|y| y.is_finite()))
    }

    /// The rows of the state, in the layout of the system.
    pub fn state(&self) -> &[Row] {
        self.stepper.state()
    }

    /// Component `number` of the state.
    pub fn component(&self, number: usize) -> f64 {
        let (row, place) = self.system.description().layout.place(number);
        self.state()[row][place]
    }

    /// Number of steps done.
    pub fn steps_done(&self) -> u64 {
        self.done
    }

    /// The time reached.
    pub fn time(&self) -> f64 {
        self.done as f64 * self.tau
    }
}
