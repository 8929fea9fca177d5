//! **Expressions as graphs, with their derivatives, evaluated on 32 points at a time.**
//!
//! In a [`Graph`] every subexpression stands once. Derivatives are further expressions of the
//! graph: gradients by reverse accumulation, directional derivatives forward, Hessian–vector
//! products by both. A [`Tape`] has the instructions for some expressions and runs them on rows of
//! 32 numbers, with the functions of [`real`] and the same bits on every instruction set.
//!
//! ```
//! use expression::{Graph, Tape, Unary};
//!
//! let mut graph = Graph::new();
//! let (x, y) = (graph.input(0), graph.input(1));
//! let (square, sin) = (graph.power(x, 2), graph.unary(Unary::Sin, y));
//! let (f, one) = (graph.mul(square, sin), graph.constant(1.0));
//! let gradient = graph.reverse(&[(f, one)], &[0, 1]);
//! let mut out = [0.0; 2];
//! Tape::new(&graph, &gradient, &[0..2]).evaluate_one(&[&[3.0, 0.5]], &mut out);
//! assert!((out[1] - 9.0 * 0.5f64.cos()).abs() < 1e-14);
//! ```
//!
//! The way through the crate: [`Graph`] (identities, `derivative`) → `compile` (powers written out,
//! operations joined, rows allocated) → [`Tape`] → `instruction` (loops over rows). [`terms`] and
//! [`Affine`] take expressions apart, and [`Values`] has something for each of them.

mod affine;
mod compile;
mod derivative;
mod graph;
mod instruction;
mod join;
mod tape;
mod terms;
mod uniform;
mod values;

pub use affine::{Affine, forms};
pub use graph::{Binary, Graph, Id, Node, Unary};
pub use instruction::{Instruction, OUT, Place, SCRATCH};
pub use tape::Tape;
pub use terms::{Weighted, terms};
pub use uniform::Numbers;
pub use values::Values;
