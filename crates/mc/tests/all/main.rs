//! The tests of the crate in one binary, so that the kernels of each system are compiled once for
//! all of them.

mod clipped;
mod damping;
mod driver;
mod dynamic;
mod expect;
mod explosive;
mod failing;
mod ladder;
mod parts;
mod simulation;
mod statistical;
mod statistics;
mod study;
