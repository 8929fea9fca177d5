//! Statistical property tests.

mod means;
mod orders;
mod tails;
