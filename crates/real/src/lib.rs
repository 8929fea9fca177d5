//! **Number types for integrators: one formula runs on one path, on a vectorised block of paths,
//! and on dual numbers for derivatives.**
//!
//! A formula is generic over [`Real`]. `f64` evaluates it and [`Dual`] differentiates it. The
//! compiler vectorises a loop of the inlined formula over the [`WIDTH`] paths of a [`Block`]. The
//! elementary functions are branch-free polynomials ([`elementary`]), so results depend neither on
//! the platform's libm nor on the instruction set that [`dispatch`] chooses at run time.
//!
//! ```
//! use real::{Dual, Real};
//!
//! // d/dx (x² sin x) at x = 2, without a derivative written by hand.
//! fn f<R: Real>(x: R) -> R {
//!     x * x * x.sin()
//! }
//! let y = f(Dual::variable(2.0));
//! assert!((y.derivative() - (4.0 * 2f64.sin() + 4.0 * 2f64.cos())).abs() < 1e-14);
//! ```
//!
//! | item | purpose |
//! |---|---|
//! | [`Real`] | operations that a formula may use |
//! | [`Dual`] | value and one directional derivative; can be nested |
//! | [`Partial`] | the same, aware of what does not vary |
//! | [`Bounded`] | value and a bound of its rounding error |
//! | [`Degree`] | the degree of a formula as a polynomial |
//! | [`Segment`] | the mean of a formula along a segment |
//! | [`gradient`], [`along`], [`seeded`], [`derivatives`] | derivatives by dual numbers |
//! | [`unrolled!`] | loops that are written out |
//! | [`Factored`] | small linear systems without branches |
//! | [`golden`] | points that are spread evenly |
//! | [`Block`], [`PathMask`] | the state of 32 paths, a subset of them |
//! | [`Row`], [`Rows`] | 32 numbers, and rows on the heap whose number is known at run time |
//! | [`exactly`], [`path`] | rows whose number the compiler knows, and the numbers of one path |
//! | [`Kernel`], [`dispatch`], [`kernel!`], [`Simd`] | run-time choice of the instruction set |
//! | [`elementary`] | branch-free sin, cos, exp, ln, sinc; powers and logarithms for results |
//! | [`coefficients`], [`sinh_cosh`] | constants and parts of the functions |
//!
//! The feature `dispatch` (default) provides the run-time choice of the instruction set and is the
//! only reason for a dependency. Without it, kernels are compiled for the baseline of the target.

mod block;
mod bounded;
#[allow(missing_docs)]
pub mod coefficients;
mod degree;
mod derivative;
#[cfg(feature = "dispatch")]
mod dispatch;
mod dual;
pub mod elementary;
mod factored;
mod functions;
mod golden;
mod number;
mod operator;
mod powers;
mod rows;
mod segment;

pub use block::{Block, PathMask, WIDTH};
pub use bounded::Bounded;
pub use degree::Degree;
pub use derivative::{ScalarFunction, along, derivatives, fixed, gradient, is_written_out, seeded};
#[cfg(feature = "dispatch")]
pub use dispatch::{Kernel, Simd, dispatch, limit_to};
pub use dual::{Dual, DualNumber, Partial, Variation, Varies};
pub use factored::Factored;
pub use functions::sinh_cosh;
pub use golden::golden;
pub use number::Real;
pub use rows::{Row, Rows, exactly, path};
pub use segment::Segment;
