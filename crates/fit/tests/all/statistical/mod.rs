//! Statistical property tests.

mod intervals;
