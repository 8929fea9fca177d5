//! Statistical property tests.

pub mod orders;
