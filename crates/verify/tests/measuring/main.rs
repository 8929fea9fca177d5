//! Tests that run where they are named: hard inputs, wrong methods that statements must refute, the
//! conformal law over ten million steps, and arbitrary inputs.
//!
//! Long runs and inputs are few here; the ignored tests have all of them:
//! `cargo test --release -p casimir-verify --test measuring -- --ignored --nocapture`.

mod bits;
mod fuzz;
mod growth;
mod hard_cases;
mod rounding;
mod twins;

/// Master seed of everything here.
const SEED: u64 = 1;
