//! Statistical property tests.

mod long_time;
mod nv;
pub mod orders;
mod space_time;
