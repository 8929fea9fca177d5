//! The program as a user calls it.

mod areas;
mod broken;
mod common;
mod defaults;
mod gallery;
mod initial;
mod parts;
mod results;
mod sweeps;
mod truths;
