//! The crate from outside.

mod bits;
mod derivatives;
mod expression;
mod fuzz;
mod grammar;
mod graph;
mod programs;
mod systems;
