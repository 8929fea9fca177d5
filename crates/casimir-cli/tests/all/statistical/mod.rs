//! Statistical property tests.

mod along;
mod baths;
mod fits;
mod stationary;
mod truths;
