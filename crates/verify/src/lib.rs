//! **The statements and figures of the paper as experiments that can fail.**
//!
//! [`reproduce()`] runs the [`EXPERIMENTS`] that make the 14 panels and the measurements behind the
//! [`STATEMENTS`], and returns [`results::Results`]: curves with standard errors, fitted orders
//! with intervals, and a verdict for every statement: holds, refuted or undecided. The pieces can
//! be used on their own: [`fit_strong`] and [`fit_weak`] fit orders with intervals from any errors
//! with a covariance.
//!
//! ```
//! use mc::CrossMoments;
//! use verify::fit_strong;
//!
//! // Squared errors of 200 paths at four step sizes, exactly of order one but for the scatter from path to path.
//! let taus = [0.1, 0.05, 0.025, 0.0125];
//! let mut squares = CrossMoments::new(4);
//! for path in 0..200 {
//!     let scatter = |l: usize| 1.0 + 0.3 * ((path * (l + 7)) as f64).sin();
//!     let errors: Vec<f64> = taus.iter().enumerate().map(|(l, tau)| tau * tau * scatter(l)).collect();
//!     squares.add(&errors);
//! }
//! let order = fit_strong(&taus, None, &squares).expect("four levels are enough");
//! assert!(order.lo < 1.0 && 1.0 < order.hi && order.hi - order.lo < 0.1, "{order:?}");
//! ```
//!
//! | item | job |
//! |---|---|
//! | [`reproduce()`], [`Settings`], [`Mode`], [`Progress`] | run everything, or a selection |
//! | [`EXPERIMENTS`], [`STATEMENTS`], [`SUPPLEMENTS`], [`panel_ids`] | what there is to run |
//! | [`strong_order`], [`weak_order`], [`Study`] | the order of any scheme on any problem |
//! | [`expectation_claims`] | E[φ(y(T))] by multilevel Monte Carlo against the Kolmogorov equation |
//! | [`TWINS`], [`measure_twins`] | wrong methods that the claims must refute |
//! | [`inspect()`], [`inspect_problem`] | what a system is: skew, Casimirs, degrees, commuting noises, which statements apply |
//! | [`PathScheme`] | a scheme written for one path, to be put to the test |
//! | [`fit_strong`], [`fit_weak`], [`fit_weak_differences`], [`order_verdict`] | orders with intervals, and when an order is said to hold |
//! | [`rigid_body_expectations`] | expectations of the rigid body with no sampling |
//! | [`coverage()`], [`CoverageRow`] | how often those intervals cover the truth |
//! | [`results`] | the `results.json` contract |

mod approach;
mod coverage;
mod exact;
mod experiment;
pub mod inspect;
mod invariant;
mod least_squares;
mod order;
mod paper;
mod path_scheme;
mod reproduce;
pub mod results;
mod runge_kutta;
mod sphere;
mod statement;
mod statements;
mod strong;
mod study;
mod supplement;
mod twins;
mod weak;

pub use coverage::{CoverageRow, Expected, coverage};
pub use experiment::{Context, Experiment, Mode, Progress, Settings, Silent};
pub use inspect::{inspect, inspect_problem};
pub use order::{
    ORDER_MARGIN, bound_verdict, fit_strong, fit_weak, fit_weak_differences, order_verdict,
    root_mean_square_interval,
};
pub use paper::EXPERIMENTS;
pub use path_scheme::PathScheme;
pub use reproduce::{UnknownPanel, check_ids, panel_ids, reproduce};
pub use sphere::rigid_body_expectations;
pub use statement::Statement;
pub use statements::STATEMENTS;
pub use study::{Exact, Order, Study, strong_order, strong_order_exact, weak_order};
pub use supplement::{SUPPLEMENTS, Supplement, expectation_claims};
pub use twins::{TWINS, Twin, measure_twins};

/// The example of the README, compiled and run with the other examples.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;

/// The snippets of the guide that stand alone.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/guide.md")]
struct Guide;
