//! Statistical property tests.

mod along;
mod baths;
mod stationary;
mod truths;
