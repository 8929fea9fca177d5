//! Tests of fits.

mod statistical;
