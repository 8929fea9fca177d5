//! **Implicit steps z = ψ(z) for 32 paths at once, each solved to round-off as if it were alone.**
//!
//! A [`FixedPoint`] is the equation of one path, written for every [`real::Real`]; a
//! [`BlockFixedPoint`] says which equation each path of a block has. [`Solver::solve_block`]
//! iterates the whole block, freezes a path when it is done, and hands the few paths that the fast
//! method cannot do to a Newton method with continuation. [`Solver::solve`] does the same for one
//! path and gives the same bits.
//!
//! ```
//! use nonlin::{FixedPoint, Solver};
//! use real::Real;
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
//! | item | job |
//! |---|---|
//! | [`FixedPoint`], [`BlockFixedPoint`] | the equation, of one path and of a block |
//! | [`FirstSweep`] | how its iteration begins: plain, unrolled, or from a prediction |
//! | [`Solver`], [`Method`] | which iteration, how many sweeps |
//! | [`BlockStatus`], [`Outcome`] | per path: converged or not, by which method, iterations, residual |

mod block;
mod elimination;
mod equation;
mod robust;
mod single;
mod solver;
mod sweep;

pub use equation::{BlockFixedPoint, FirstSweep, FixedPoint};
pub use solver::{BlockStatus, Method, Outcome, Solution, Solver};
