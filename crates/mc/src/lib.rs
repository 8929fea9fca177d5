//! **One pass over the finest noise drives every scheme at every step size.**
//!
//! A [`Ladder`] says which schemes run at which levels of a dyadic ladder of steps; [`Ladder::run`]
//! advances blocks of paths through it in parallel and folds them into a [`Statistic`]. Partial
//! sums are merged on a fixed tree, so one thread, many threads and any instruction set give the
//! same bits; memory grows neither with samples nor with steps. [`trajectory`] follows a single
//! path and keeps it.
//!
//! ```
//! use mc::{Ladder, Reference, Run, StrongErrors};
//! use noise::{StreamKey, Truncation};
//! use schemes::{EulerMaruyama, Sexp};
//! use systems::{Constant, Pendulum, Problem};
//!
//! let problem = Problem::new(Pendulum::new(1.0)?, Constant::new(2.0)?, [0.2, 1.0], 1.0)?;
//! let (sexp, em) = (Sexp::default(), EulerMaruyama);
//! // The reference at 256 steps, then both schemes at 32 steps (level 3).
//! let runs = vec![Run::new(&sexp, 0), Run::new(&sexp, 3), Run::new(&em, 3)];
//! let key = StreamKey { seed: 1, experiment: 1 };
//! let ladder = Ladder::new(&problem, 256, 3, Truncation::new(4)?, key, runs)?;
//! let series = [vec![1], vec![2]];
//! let outcome = ladder.run(64, || StrongErrors::new(Reference::Run(0), &series, ladder.coarse_steps()), &|_| ());
//! let mean_square = |s: usize| outcome.statistic.at_end(s).mean(0);
//! assert!(mean_square(0) < 0.1 * mean_square(1));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | item | job |
//! |---|---|
//! | [`Ladder`], [`Run`] | which schemes at which steps, on which noise |
//! | [`Statistic`]: [`StrongErrors`], [`WeakDifferences`] | what is kept of the paths |
//! | [`TimeChange`] | a random time carried along each path, for exact references |
//! | [`NoiseSource`] | noise from elsewhere |
//! | [`trajectory`] | one path, kept |
//! | [`Simulation`], [`TimeSeries`], [`write_csv`], [`write_json`] | paths with observables and conformal defects, as tables |
//! | [`Recording`] | the increments of a path, from or for another code |
//! | [`PathFailure`] | a path that was left out: where, when and why |
//! | [`multilevel`] | E[φ(y(T))] to a requested accuracy |

mod driver;
mod error;
mod failure;
mod ladder;
pub mod multilevel;
mod noise_source;
mod parallel;
mod recording;
mod simulation;
mod strong;
mod trajectory;
mod tree;
mod weak;

pub use error::LadderError;
pub use failure::{Cause, PathFailure};
pub use ladder::{Ladder, Measured, Run, Statistic, TimeChange, View};
pub use noise_source::{NextNoise, NoiseSource};
pub use recording::{Recording, RecordingError};
pub use simulation::{
    Column, NoiseOrigin, Simulation, SimulationError, TimeSeries, write_csv, write_json,
};
pub use strong::{Reference, StrongErrors};
pub use trajectory::{Trajectory, trajectory};
pub use weak::{Observable, WeakDifferences};
