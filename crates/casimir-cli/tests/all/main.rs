//! The program as a user calls it.

mod along;
mod areas;
mod broken;
mod chains;
mod citation;
mod common;
mod defaults;
mod doctor;
mod friction;
mod gallery;
mod hostile;
mod initial;
mod ito;
mod parts;
mod promised;
mod resolution;
mod resting;
mod results;
mod shorthand;
mod single;
mod stationary;
mod sweeps;
mod time;
mod truths;
mod warnings;
mod wrong_numbers;
