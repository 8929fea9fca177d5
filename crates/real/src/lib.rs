//! **Numbers for integrators that are written once and run three ways**: on one path, on a
//! vectorised block of paths, and on dual numbers for derivatives.
//!
//! A formula is written for every [`Real`]; `f64` evaluates it, [`Dual`] differentiates it, and a
//! loop over the [`WIDTH`] paths of a [`Block`] with the formula inlined is turned into vector
//! instructions by the compiler. The elementary functions are our own branch-free polynomials
//! ([`elementary`]), so that a value does not depend on the platform's libm, nor on the instruction
//! set that [`dispatch`] picks at run time.
//!
//! ```
//! use real::{Dual, Real};
//!
//! // d/dx (x² sin x) at x = 2, without writing a derivative.
//! fn f<R: Real>(x: R) -> R {
//!     x * x * x.sin()
//! }
//! let y = f(Dual::variable(2.0));
//! assert!((y.derivative - (4.0 * 2f64.sin() + 4.0 * 2f64.cos())).abs() < 1e-14);
//! ```
//!
//! | item | job |
//! |---|---|
//! | [`Real`] | what a formula may ask of a number |
//! | [`Dual`] | value and one directional derivative, nestable |
//! | [`gradient`], [`directional`] | the two derivatives that integrators ask for |
//! | [`Block`], [`PathMask`] | the state of 32 paths, and a subset of them |
//! | [`Kernel`], [`dispatch`], [`Level`] | run a block kernel on the widest instruction set, or on a chosen one |
//! | [`elementary`] | branch-free sin, cos, exp, ln, sinc |
//!
//! The feature `dispatch`, on by default, is the choice of the instruction set and the only thing
//! here that needs another crate. Without it kernels are compiled for the baseline of the target.

mod block;
mod derivative;
#[cfg(feature = "dispatch")]
mod dispatch;
mod dual;
pub mod elementary;
mod number;

pub use block::{Block, PathMask, WIDTH};
pub use derivative::{ScalarFunction, VectorFunction, directional, gradient, jacobian};
#[cfg(feature = "dispatch")]
pub use dispatch::{Kernel, Level, dispatch, limit_to};
pub use dual::Dual;
pub use number::Real;
