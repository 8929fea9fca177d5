//! The program as a user calls it.

mod broken;
mod common;
mod parts;
mod results;
