//! **The statements and figures of the paper as experiments that can fail.**
//!
//! [`reproduce()`] runs the [`EXPERIMENTS`] that make the 14 panels, the measurements behind the
//! [`STATEMENTS`] and the [`SUPPLEMENTS`], and returns [`results::Results`]: curves with
//! standard errors, fitted orders with intervals, and a verdict for every statement: holds, refuted
//! or undecided.
//!
//! ```
//! let quick = true;
//! let found = verify::reproduce(1, quick, &["exact-conformal"]);
//! assert!(found.claims.iter().all(|claim| claim.verdict == verify::results::Verdict::Holds));
//! ```
//!
//! | item | job |
//! |---|---|
//! | [`reproduce()`] | run everything, or a selection |
//! | [`EXPERIMENTS`], [`STATEMENTS`], [`SUPPLEMENTS`] | panels, statements, other figures |
//! | [`weak_observables()`] | the test functions of the weak panels |
//! | [`ids`] | what there is to run |
//! | [`Experiment`], [`Conditions`], [`Findings`] | what an experiment is, is given and returns |
//! | [`statements`], [`conformal_law`] | measurements that twins repeat on wrong methods |
//! | [`Compiled`], [`Curve`] | the schemes of [`kernels`] on a problem |
//! | [`altered()`] | a method on another step or other noise |
//! | [`streams`] | which noise belongs to which experiment |
//! | [`results`] | the `results.json` contract: measurements as data, verdicts in words |
//! | [`page`] | the report of a run |
//! | [`command`] | what the command lines of all programs share |
//!
//! The program of this package is `reproduce`; `benches/speed` is `cargo xtask bench`.

mod altered;
pub mod command;
mod compiled;
pub mod conformal_law;
mod evidence;
mod exact;
mod experiment;
pub mod page;
mod panels;
mod reproduce;
pub mod results;
mod runge_kutta;
pub mod statements;
pub mod streams;
mod supplements;
mod two_spins;
mod verdict;

pub use altered::altered;
pub use compiled::{Compiled, Curve};
pub use experiment::{Conditions, Experiment, Findings, truncation};
pub use panels::{EXPERIMENTS, weak_observables};
pub use reproduce::{ids, reproduce};
pub use statements::STATEMENTS;
pub use supplements::{KOLMOGOROV, SUPPLEMENTS};

// The names that experiments share.
use analysis::{FinalMoments, worse};
use conformal_law::{along, largest_defect};
use experiment::*;
use kernels::Tuned;
use mc::{Ladder, Observable, Run, Setup, View};
use noise::{StepNoise, StreamKey, Truncation, WienerPath};
use panels::{
    phi,
    strong::{StrongPanel, power_of_half},
};
use real::{Row, WIDTH, elementary};
use results::*;
use runge_kutta::runge_kutta;
use schemes::{BuiltIn, Step};
use stats::{CrossMoments, Expansion};
use systems::{
    Damping, PoissonSystem, Problem,
    paper::{self, rigid_body_three_noises, valid},
};

/// The examples of the README, compiled and run with the other examples.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;

/// The snippets of the guide that stand alone.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/guide.md")]
struct Guide;

/// One system in Rust, beside the program and Python.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/start.md")]
struct Start;
