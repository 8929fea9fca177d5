//! The program as a user calls it.

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
mod kept;
mod parts;
mod promised;
mod resolution;
mod resting;
mod results;
mod shorthand;
mod single;
mod statistical;
mod sweeps;
mod time;
mod warnings;
mod written;
mod wrong_numbers;
