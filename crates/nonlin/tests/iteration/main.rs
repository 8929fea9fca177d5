//! The tests of the solver in one binary.

mod bits;
mod common;
mod contraction;
mod excursion;
mod failure;
mod predicted;
mod rescue;
mod status;
