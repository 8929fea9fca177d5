//! Statistical property tests.

mod dependence;
pub mod judged;
pub mod random_points;
mod space_time;
mod tails;
