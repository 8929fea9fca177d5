//! **Which scheme is cheapest for which error.**
//!
//! For each of the paper's systems and each scheme, errors at several step sizes are measured on a
//! ladder, untimed and the same bits on any machine; then the processor time of a path at each step
//! size is measured on its own, on one thread, all schemes in turn. Put together they are the
//! work–precision curves of `cargo xtask work-precision`.
//!
//! ```
//! use precision::cost_at;
//!
//! // (error, cost) at four step sizes of a scheme of order one: half the error for twice the cost.
//! let curve = [(0.08, 1.0), (0.04, 2.0), (0.02, 4.0), (0.01, 8.0)];
//! assert!((cost_at(&curve, 0.02).unwrap() - 4.0).abs() < 1e-12);
//! assert!((cost_at(&curve, 0.03).unwrap() - 8.0 / 3.0).abs() < 1e-12);
//! assert_eq!(cost_at(&curve, 0.001), None);
//! ```
//!
//! | item | job |
//! |---|---|
//! | [`measure`], [`Settings`](verify::Settings), [`check_ids`], [`case_ids`] | run everything, or a selection |
//! | [`results`] | the `work-precision.json` contract |
//! | [`Time`](results::Time) | how a processor time is measured and what its spread is |
//! | [`cost_at`] | what a given error costs, between the measured points |

mod cases;
mod clock;
mod compare;
mod cost;
mod ends;
mod own_areas;
mod plan;
pub mod results;

pub use cases::{UnknownCase, case_ids, check_ids, measure};
pub use compare::{Crossing, cost_at, crossing};
