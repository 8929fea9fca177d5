//! Statistical property tests.

mod along;
mod stationary;
mod truths;
