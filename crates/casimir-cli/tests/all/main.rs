//! The program as a user calls it.

mod broken;
mod common;
mod cost;
mod gallery;
mod parts;
mod results;
mod truths;
