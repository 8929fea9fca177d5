//! **Implicit equations z = ψ(z) for 32 paths at once, solved to a residual of 2ε.**
//!
//! A [`FixedPoint`] is the equation of one path, generic over [`real::Real`]. A [`BlockFixedPoint`]
//! gives the equation of each path of a block. [`Solver::solve_block`] iterates on the whole block
//! and freezes converged paths. Paths on which the fast method fails are solved by Newton's method
//! with continuation. [`Solver::solve`] solves the equation of one path, with the same bits.
//!
//! The way through the crate: `equation` → `solver` → `block` or `single` → `sweep` (one pass of
//! the fast method) → `robust` (where it fails, with `elimination`). [`criteria`] say when to stop.
//!
//! ```
//! use nonlin::{FixedPoint, Solver, real::Real};
//!
//! /// Kepler's equation E = M + e sin E.
//! #[derive(Clone, Copy)]
//! struct Kepler;
//! impl FixedPoint<1> for Kepler {
//!     fn start(&self) -> [f64; 1] {
//!         [0.8]
//!     }
//!     fn map<R: Real>(&self, z: [R; 1]) -> [R; 1] {
//!         [z[0].sin() * 0.3 + 0.8]
//!     }
//! }
//! let solution = Solver::default().solve(&Kepler);
//! let [anomaly] = solution.z;
//! assert!(solution.outcome.converged());
//! assert!((anomaly - 0.3 * anomaly.sin() - 0.8).abs() < 1e-15);
//! ```
//!
//! | item | purpose |
//! |---|---|
//! | [`FixedPoint`], [`BlockFixedPoint`] | the equation of one path, of a block |
//! | [`FirstSweep`] | how the iteration begins: plain, unrolled, or with a prediction |
//! | [`Solver`], [`Method`] | the iteration and the number of its sweeps |
//! | [`solve`], [`solve_block`] | with default options and less code: the method that is preferred |
//! | [`Solution`], [`Outcome`] | the result on one path: method, iterations, residual |
//! | [`BlockStatus`] | the results on a block |
//! | [`criteria`] | when an iteration has converged |

pub use real;

mod block;
pub mod criteria;
mod elimination;
mod equation;
mod robust;
mod single;
mod solver;
mod sweep;

pub use block::solve_block;
pub use equation::{BlockFixedPoint, FirstSweep, FixedPoint};
pub use single::solve;
pub use solver::{BlockStatus, Method, Outcome, Solution, Solver, are_finite};
