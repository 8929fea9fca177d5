//! The crate from outside.

mod bits;
mod derivatives;
mod expression;
mod flows;
mod fuzz;
mod grammar;
mod graph;
mod large;
mod panels;
#[path = "../../examples/paper/mod.rs"]
mod paper;
mod plain;
mod programs;
mod systems;
