//! **Monte Carlo simulation of many schemes at many step sizes with the same noise.**
//!
//! A [`Ladder`] lists schemes and their levels on a dyadic ladder of steps. [`Ladder::run`]
//! advances blocks of paths in parallel and accumulates a [`Statistic`]. Partial results are merged
//! on a fixed tree, so the bits do not depend on threads or instruction sets. Memory grows neither
//! with samples nor with steps. [`Simulation`] stores whole paths.
//!
//! ```
//! use mc::{Ladder, Run, Statistic, View, bind};
//! use noise::{StreamKey, Truncation};
//! use schemes::{EulerMaruyama, Sexp};
//! use systems::{Constant, Pendulum, Problem};
//!
//! /// Sums of the squares of the errors of two runs against a third one at T.
//! #[derive(Default)]
//! struct Errors([f64; 2]);
//!
//! impl Statistic for Errors {
//!     fn observe(&mut self, view: &View<'_>) {
//!         for p in view.live.paths().filter(|_| view.time == 32) {
//!             let [x, a, b] = [0, 1, 2].map(|run| view.path::<2>(run, p));
//!             let square = |y: [f64; 2]| (y[0] - x[0]).powi(2) + (y[1] - x[1]).powi(2);
//!             self.0 = [self.0[0] + square(a), self.0[1] + square(b)];
//!         }
//!     }
//!     fn merge(&mut self, later: Self) {
//!         self.0 = [self.0[0] + later.0[0], self.0[1] + later.0[1]];
//!     }
//! }
//!
//! let problem = Problem::new(Pendulum::new(1.0)?, Constant::new(2.0)?, [0.2, 1.0], 1.0)?;
//! let (sexp, em) = (Sexp, EulerMaruyama);
//! // The reference at 256 steps, then both schemes at 32 steps (level 3).
//! let (sexp, em) = (bind(&problem, &sexp), bind(&problem, &em));
//! let runs = vec![Run::new(sexp.clone(), 0), Run::new(sexp, 3), Run::new(em, 3)];
//! let key = StreamKey { seed: 1, experiment: 1 };
//! let ladder = Ladder::new(&mc::Problem::of(&problem), 256, 3, Truncation::new(4)?, key, runs)?;
//! let [sexp, em] = ladder.run(64, Errors::default).statistic.0;
//! assert!(sexp < 0.1 * em);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | item | purpose |
//! |---|---|
//! | [`Ladder`], [`Run`] | schemes at step sizes, driven by the same noise |
//! | [`Statistic`], [`View`] | results over paths |
//! | [`TimeChange`] | a random time along each path, for exact references |
//! | [`NoiseSource`] | noise given by the user |
//! | [`DampingResolution`] | whether step sizes resolve the damping |
//! | [`DriveResolution`] | whether they resolve Hamiltonians that change with time |
//! | [`Simulation`], [`TimeSeries`] | tables of states, observables and invariants |
//! | [`write_csv`] | tables as files |
//! | [`Problem`], [`bind`], [`Setup`] | a problem, a scheme on its system, and both |
//! | [`Setup::collecting`], [`Along`] | integrals and first passages along paths |
//! | [`PathFailure`] | a failed path: scheme, step, time and reason |
//! | [`parts`], [`Kept`] | a study on many machines, with checkpoints |
//! | [`files`] | files that are written whole or not at all |
//!
//! Dimension and number of noises are no part of a type here: [`Problem::of`], [`Setup::of`] and
//! [`bind`] take what the compiler knows, [`Problem::at_run_time`] and [`Setup::at_run_time`]
//! systems known at run time, such as formulas.

mod along;
mod checkpoint;
mod damping_resolution;
mod drive;
mod error;
pub mod files;
mod friction;
mod ladder;
mod memory;
mod observable;
mod parallel;
pub mod parts;
mod run_time;
mod setup;
mod simulation;
mod tree;

pub use along::{Along, Gradient, OfStates, Passage};
pub use checkpoint::Checkpoint;
pub use damping_resolution::DampingResolution;
pub use drive::DriveResolution;
pub use error::{Cause, LadderError, PathFailure, RunError};
pub use friction::Friction;
pub use ladder::driver::{GROUP_PATHS, NextNoise, NoiseSource, drawn};
pub use ladder::{Kept, Ladder, Measured, Nodes, Statistic, TimeChange, View};
pub use memory::{MemoryError, demand};
pub use observable::{Observable, Observe, StateFunction, add_rows, value_at};
pub use parallel::in_parallel;
pub use run_time::bind_at_run_time;
pub use setup::{
    Coefficients, ConformalLaw, InTimeAt, Initial, Problem, Run, Setup, bind, bind_owned,
};
pub use simulation::{Column, NoiseOrigin, Role, Simulation, TimeSeries, quoted, write_csv};
pub use tree::Node;
