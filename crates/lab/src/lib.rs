//! **The statements and figures of the paper as experiments that can fail.**
//!
//! [`reproduce()`] runs the [`EXPERIMENTS`] that make the 14 panels and the measurements behind the
//! [`STATEMENTS`], and returns [`verify::results::Results`]: curves with standard errors, fitted
//! orders with intervals, and a verdict for every statement: holds, refuted or undecided.
//!
//! | item | job |
//! |---|---|
//! | [`reproduce()`] | run everything, or a selection |
//! | [`EXPERIMENTS`], [`STATEMENTS`], [`SUPPLEMENTS`], [`panel_ids`], [`check_ids`] | what there is to run |
//! | [`Compiled`] | every scheme on every system of the paper, compiled once |
//! | [`setups`] | the problems on which schemes are compared, with the schemes for each |
//! | [`command`] | what the command lines of all programs share |
//! | [`expectation_claims`] | E[φ(y(T))] by multilevel Monte Carlo against the Kolmogorov equation |
//! | [`TWINS`], [`measure_twins`] | wrong methods that the claims must refute |
//! | [`coverage()`], [`CoverageRow`] | how often the intervals of `stats` cover the truth |

mod approach;
pub mod command;
mod coverage;
mod experiment;
mod invariant;
pub mod kernels;
mod panels;
mod reproduce;
pub mod setups;
mod statements;
mod strong;
mod supplement;
mod twins;
mod weak;

pub use coverage::{CoverageRow, Expected, coverage};
pub use experiment::{Context, Experiment, Statement, Twin, Yield};
pub use kernels::Compiled;
pub use panels::EXPERIMENTS;
pub use reproduce::{UnknownPanel, check_ids, panel_ids, reproduce};
pub use statements::STATEMENTS;
pub use supplement::{SUPPLEMENTS, Supplement, expectation_claims};
pub use twins::{TWINS, measure_twins};
