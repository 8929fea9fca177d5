//! Systems whose dimension and number of noises are known at run time, such as formulas from a file
//! and lattices.
//!
//! States are rows of 32 numbers on the heap. For an ensemble of small systems row i is component i
//! of 32 paths. For one path of a large system the rows are pieces of its state, in an order that
//! the system chooses. A [`System`] has a [`Description`], which is data, and applies every [`Op`],
//! such as B(y)v and ∇h, to rows. Results are written to rows that it is given; nothing is
//! allocated.
//!
//! [`Compiled`] makes a [`PoissonSystem`](crate::PoissonSystem) such a system, with the same bits.
//!
//! ```
//! use real::Rows;
//! use systems::run_time::{Compiled, Op, System, Weights};
//! use systems::RigidBody;
//!
//! let body = RigidBody::three_noises([2.0, 1.0, 0.5], [1.0, 2.0, 3.0])?;
//! let system = Compiled::new(body, [0.6, 0.0, 0.8]);
//! let description = system.description();
//! assert_eq!((description.dimension, description.noises), (3, 3));
//! let (y, dw) = (Rows::splat(&[0.6, 0.0, 0.8]), Rows::splat(&[0.1, -0.2, 0.3]));
//! let (mut gradient, mut field) = (Rows::zero(3), Rows::zero(3));
//! let mut scratch = Rows::zero(description.scratch_rows());
//! let h = Weights { dt: 0.01, dw: &dw, ..Weights::NONE };
//! system.apply(Op::Gradient { y: &y }, 0..3, h, &mut gradient, &mut scratch);
//! system.apply(Op::Structure { y: &y, v: &gradient }, 0..3, h, &mut field, &mut scratch);
//! // B∇h is tangent to the level sets of ½|y|².
//! assert!((y[0][7] * field[0][7] + y[2][7] * field[2][7]).abs() < 1e-16);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod compiled;
mod derived;
mod description;
mod moves;
mod op;
mod problem;
mod system;

pub use compiled::Compiled;
pub use derived::derived;
pub use description::{Description, Lanes, Layout};
pub use moves::{Move, Parts, palindrome};
pub use op::{MAX_INPUTS, Op, Program, Recorded};
pub use problem::Problem;
pub use system::{InTime, System, Weights};
