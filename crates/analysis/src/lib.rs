//! **What a scheme does on a system, by measurements that can fail.**
//!
//! [`strong_order`] and [`weak_order`] measure the order of a scheme with an interval;
//! [`compare()`] says which scheme is cheapest for an error. The crate `inspect` describes the
//! system.
//!
//! ```
//! use analysis::{StepSizes, strong_order};
//! use mc::Setup;
//! use noise::{StreamKey, Truncation};
//! use schemes::Heun;
//! use systems::{Constant, Pendulum, Problem};
//!
//! let problem = Problem::new(Pendulum::new(1.0)?, Constant::new(2.0)?, [0.2, 1.0], 1.0)?;
//! let key = StreamKey { seed: 1, experiment: 1 };
//! let sizes = StepSizes { samples: 256, ..StepSizes::new(16, Truncation::new(4)?, key) };
//! let order = strong_order(&Setup::of(&problem, &Heun), &sizes)?;
//! assert_eq!(order.order(), Some(1.0), "{order}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | item | job |
//! |---|---|
//! | [`strong_order`], [`weak_order`] | the order of any scheme, in one measurement or a budget |
//! | [`Order`], [`Decision`], [`OneStep`], [`Limit`], [`wrong_limit`] | an order, its reasons |
//! | [`StepSizes`] | how it is measured |
//! | [`Exact`] | an exact solution on sampled paths |
//! | [`Referee`], [`SolverStates`], [`Judged`], [`Claims`], [`Verdicts`] | solvers that are not ours |
//! | [`compare()`], [`Candidates`], [`CompareSettings`] | which scheme is cheapest for an error |
//! | [`FinalMoments`], [`Stopwatch`], [`Spread`], [`number()`], [`aligned`], [`worse`] | moments; times; digits, tables |
//! | [`step_check()`], [`StepCheck`], [`StepError`] | whether the steps of a run are short enough |

pub mod compare;
mod final_moments;
mod number;
mod orders;
mod step_check;
mod stopwatch;

pub use compare::{Candidates, CompareSettings, Comparison, compare};
pub use stats::worse;
pub use {final_moments::*, number::*, orders::*, step_check::*, stopwatch::*};
