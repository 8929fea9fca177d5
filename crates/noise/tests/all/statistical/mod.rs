//! Statistical property tests.

pub mod areas;
mod battery;
mod check;
mod law;
mod quasi;
mod statistics;
mod truncation;
