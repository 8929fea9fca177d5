//! The tests of the crate in one binary, so that the kernels of each system are compiled once for
//! all of them.

mod clipped;
mod damping;
mod dependence;
mod driver;
mod dynamic;
mod expect;
mod explosive;
mod failing;
mod judged;
mod ladder;
mod lattice;
mod parts;
mod random_points;
mod simulation;
mod statistics;
mod study;
mod tails;
