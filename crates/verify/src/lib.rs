//! **The statements and figures of the paper as experiments that can fail.**
//!
//! [`reproduce()`] runs the [`EXPERIMENTS`] that make the 14 panels, the measurements behind the
//! [`STATEMENTS`] and the [`SUPPLEMENTS`], and returns [`results::Results`]: curves with
//! standard errors, fitted orders with intervals, and a verdict for every statement: holds, refuted
//! or undecided.
//!
//! | item | job |
//! |---|---|
//! | [`reproduce()`] | run everything, or a selection |
//! | [`EXPERIMENTS`], [`STATEMENTS`], [`SUPPLEMENTS`] | panels, statements, other figures |
//! | [`ids`] | what there is to run |
//! | [`Experiment`], [`Conditions`], [`Findings`] | what an experiment is, is given and returns |
//! | [`statements`], [`conformal_law`] | measurements that twins repeat on wrong methods |
//! | [`Compiled`], [`Curve`] | the schemes of [`kernels`] on a problem |
//! | [`Altered`] | a method on another step or other increments |
//! | [`TwoSpins`] | a system in six dimensions |
//! | [`OtherNoise`] | a scheme on other noise than the driver's |
//! | [`streams`] | which noise belongs to which experiment |
//! | [`results`] | the `results.json` contract: measurements as data, verdicts in words |
//! | [`page`] | the report of a run |
//! | [`Settings`], [`Mode`] | how much to compute |
//! | [`rounding`] | what rounding can do to a conformal law |
//! | [`command`] | what the command lines of all programs share |
//! | [`weak_observables`] | the test functions of the weak panels |
//!
//! The programs of this package are `reproduce`, `hard-cases` and `bench`; what
//! one of them alone needs is in its folder.

mod altered;
pub mod command;
mod compiled;
pub mod conformal_law;
mod evidence;
mod exact;
mod experiment;
mod other_noise;
pub mod page;
mod panels;
mod reproduce;
pub mod results;
pub mod rounding;
mod runge_kutta;
mod settings;
mod sphere;
pub mod statements;
pub mod streams;
mod supplements;
mod two_spins;
mod verdict;

pub use altered::Altered;
pub use compiled::{Compiled, Curve};
pub use experiment::{
    Conditions, Experiment, FURTHER, Findings, TRUNCATED, TRUNCATION_ORDER, truncation,
};
use experiment::{Words, in_words};
pub use other_noise::OtherNoise;
pub use panels::{EXPERIMENTS, weak_observables};
pub use reproduce::{ids, reproduce};
pub use settings::{Mode, Settings};
pub use statements::STATEMENTS;
pub use supplements::SUPPLEMENTS;
pub use two_spins::TwoSpins;
