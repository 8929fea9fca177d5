//! The schemes on systems whose dimension is known at run time.
//!
//! A scheme has one formula for compiled systems and for these: here the formula is recorded as a
//! list of operations on states, and the list is executed on rows of 32 numbers, tile by tile. A
//! [`Stepper`](crate::Stepper) holds the state of 32 paths, or of one large path, whose tiles are computed in
//! parallel; the bits do not depend on the number of threads. Memory is a few states, and nothing
//! is allocated in a step unless a formula stores more than four results at a time.
//!
//! Implicit equations are solved by fixed-point iteration, and where that does not converge by
//! Newton's method with continuation whose linear equations are solved without a matrix.
//!
//! ```
//! use noise::StepNoise;
//! use nonlin::BlockStatus;
//! use real::Rows;
//! use schemes::{Sexp, Step, run_time::Scheme};
//! use systems::{Constant, RigidBody, run_time::Compiled};
//!
//! let (damping, y0) = (Constant::new(0.2)?, [0.6, 0.0, 0.8]);
//! let body = RigidBody::three_noises([2.0, 1.0, 0.5], [1.0, 2.0, 3.0])?;
//! let system = Compiled::new(body, y0);
//! let mut paths = Sexp.stepper(&system)?;
//! paths.state_mut().copy_from_slice(&Rows::splat(&y0)?);
//! let step = Step::new(&damping, 0, 0.01)?;
//! let noise = StepNoise::from(Rows::splat(&[0.1, -0.2, 0.1])?);
//! let mut status = BlockStatus::explicit();
//! paths.step(&step, &noise, &mut status);
//! let square: f64 = paths.state().iter().map(|row| row[31] * row[31]).sum();
//! let law = (-2.0 * step.damping_integral()).exp();
//! assert!(status.failed.is_empty() && (square / law - 1.0).abs() < 1e-15);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod derivative;
mod explicit;
mod implicit;
mod krylov;
mod machine;
mod norm;
mod plan;
mod record;
mod scheme;
mod sweep;
mod without_iteration;

pub use scheme::{Scheme, SchemeError};
