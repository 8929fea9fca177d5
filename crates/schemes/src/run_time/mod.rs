//! The schemes on systems whose dimension is known at run time.
//!
//! A formula is the same for compiled systems and for these. The way of a step:
//!
//! [`Implicit`](crate::Implicit) formula → `record` (a list of operations) → `plan` (stages and
//! memory), or a [`Program`](systems::run_time::Program) of the system → `machine` (runs it on
//! rows, tile by tile) → `stepper` (with fixed-point iteration if implicit) and, where that does
//! not converge, `krylov` (Newton's method with continuation) with `derivative`.
//!
//! **Stages.** Operations are computed tile by tile, each tile in memory of its own that fits a
//! cache. ∇h on a tile reads all of its argument, which therefore has to be complete: operations
//! are divided into stages, and what a later stage reads is stored in a whole buffer. A buffer is
//! used again as soon as its content is no longer needed.
//!
//! **Slabs.** A stage reads of the stages before it what is at most
//! [`Layout::reach`](systems::run_time::Layout::reach) tiles away. So the stages of a step follow
//! each other through the state, slab by slab of at least this number of tiles, and what a stage
//! stores is still in a cache when the next one reads it. Slabs are counted around. Stage s begins
//! at slab s, and stage s of slab k comes right after stage s − 1 of slab k + 1. A result that
//! takes the place of another one does so on slabs that no earlier stage has yet to read: those are
//! ahead.
//!
//! A [`Stepper`](crate::Stepper) holds the state of 32 paths, or of one large path, whose tiles are
//! computed in parallel; the bits do not depend on the number of threads. Memory is a few states,
//! and nothing is allocated in a step unless a formula stores more than four results at a time.
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
//! paths.state_mut().copy_from_slice(&Rows::splat(&y0));
//! let step = Step::new(&damping, 0, 0.01)?;
//! let noise = StepNoise::from(Rows::splat(&[0.1, -0.2, 0.1]));
//! let mut status = BlockStatus::explicit();
//! paths.step(&step, &noise, &mut status);
//! let square: f64 = paths.state().iter().map(|row| row[31] * row[31]).sum();
//! let law = (-2.0 * step.damping_integral()).exp();
//! assert!(status.failed.is_empty() && (square / law - 1.0).abs() < 1e-15);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub(crate) mod composition;
mod derivative;
mod krylov;
mod machine;
mod norm;
mod plan;
mod record;
pub(crate) mod scheme;
mod stepper;

pub use crate::SchemeError;
pub use scheme::Scheme;
