//! Tests that judge a random sample.

mod metropolis;
