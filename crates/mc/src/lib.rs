//! **Monte Carlo simulation of many schemes at many step sizes with the same noise.**
//!
//! A [`Ladder`] lists schemes and their levels on a dyadic ladder of steps. [`Ladder::run`]
//! advances blocks of paths in parallel and accumulates a [`Statistic`]. Partial results are merged
//! on a fixed tree, so the bits do not depend on threads or instruction sets. Memory grows neither
//! with samples nor with steps. [`trajectory`] and [`Simulation`] store whole paths.
//!
//! ```
//! use mc::{Ladder, Reference, Run, StrongErrors, bind};
//! use noise::{StreamKey, Truncation};
//! use schemes::{EulerMaruyama, Sexp};
//! use systems::{Constant, Pendulum, Problem};
//!
//! let problem = Problem::new(Pendulum::new(1.0)?, Constant::new(2.0)?, [0.2, 1.0], 1.0)?;
//! let (sexp, em) = (Sexp, EulerMaruyama);
//! // The reference at 256 steps, then both schemes at 32 steps (level 3).
//! let (sexp, em) = (bind(&problem, &sexp), bind(&problem, &em));
//! let runs = vec![Run::new(sexp.clone(), 0), Run::new(sexp, 3), Run::new(em, 3)];
//! let key = StreamKey { seed: 1, experiment: 1 };
//! let ladder = Ladder::new(&mc::Problem::of(&problem), 256, 3, Truncation::new(4)?, key, runs)?;
//! let series = [vec![1], vec![2]];
//! let errors = || StrongErrors::new(Reference::Run(0), &series, ladder.coarse_steps());
//! let measured = ladder.run(64, errors, &|_| ());
//! let mean_square = |s: usize| measured.statistic.at_end(s).errors.mean(0);
//! assert!(mean_square(0) < 0.1 * mean_square(1));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | item | purpose |
//! |---|---|
//! | [`Ladder`], [`Run`] | schemes at step sizes, driven by the same noise |
//! | [`Statistic`] | results over paths: [`StrongErrors`] with its [`Squares`] |
//! | [`WorstTimes`] | when an error is largest |
//! | [`TimeChange`] | a random time along each path, for exact references |
//! | [`NoiseSource`] | noise given by the user |
//! | [`DampingResolution`] | whether step sizes resolve the damping |
//! | [`trajectory`] | the states of one path |
//! | [`Simulation`], [`TimeSeries`] | tables of states, observables and invariants |
//! | [`write_csv`], [`write_json`] | tables as files |
//! | [`mod@study`], [`StudySettings`] | means, quantiles and histograms of many paths in time |
//! | [`Problem`], [`bind`], [`Setup`] | a problem, a scheme on its system, and both |
//! | [`LargePath`] | one path of a large system |
//! | [`Recording`] | the increments of a path, to exchange with other programs |
//! | [`PathFailure`] | a failed path: scheme, step, time and reason |
//! | [`mod@expect`], [`Expect`] | E[φ(y(T))] to a given accuracy, scheme chosen or given |
//! | [`parts`], [`Kept`] | a study on many machines, with checkpoints |
//!
//! Dimension and number of noises are no part of a type here: [`Problem::of`], [`Setup::of`] and
//! [`bind`] take what the compiler knows, [`Problem::at_run_time`] and [`Setup::at_run_time`]
//! systems known at run time, such as formulas.

mod damping_resolution;
mod driver;
mod error;
pub mod expect;
mod failure;
mod ladder;
mod large_path;
mod noise_source;
mod observable;
mod parallel;
pub mod parts;
mod recording;
mod run_time;
mod setup;
mod simulation;
mod strong;
pub mod study;
mod trajectory;
mod tree;

pub use damping_resolution::DampingResolution;
pub use error::LadderError;
pub use expect::{Expect, expect};
pub use failure::{Cause, PathFailure};
pub use ladder::{Kept, Ladder, Measured, Statistic, TimeChange, View};
pub use large_path::{LargePath, LargePathError};
pub use noise_source::{NextNoise, NoiseSource};
pub use observable::{Observable, Observe, RowFunction, StateFunction};
pub use recording::{Recording, RecordingError};
pub use setup::{ConformalLaw, Formulas, Problem, Run, Setup, bind, bind_owned};
pub use simulation::{
    Column, NoiseOrigin, Simulation, SimulationError, TimeSeries, write_csv, write_json,
};
pub use strong::{Reference, Squares, StrongErrors, WorstTimes, squared_distance};
pub use study::{Study, StudyError, StudyResult, StudySettings, Times, study};
pub use trajectory::{Trajectory, trajectory};
