//! The tests of the systems in one binary, so that each system is compiled once for all of them.

mod by_hand;
mod common;
mod commutators;
mod crystal;
mod lattice;
mod provided;
mod run_time;
mod structure;
mod validation;
