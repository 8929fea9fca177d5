//! Figures that are not in the paper.

mod exact_references;
mod expectations;
mod levy;
mod truncation_orders;

pub use expectations::expectation_claims;

use crate::experiment::{Experiment, Measurement};

/// All of them.
pub const SUPPLEMENTS: &[&dyn Experiment] = &[
    &Measurement { id: "truncation-orders", measure: truncation_orders::measure, long: false },
    &exact_references::LOTKA_VOLTERRA,
    &exact_references::RIGID_BODY,
    &Measurement { id: "spin-pair-levy", measure: levy::measure, long: true },
    &Measurement { id: "rigid-body-expectations", measure: expectations::measure, long: true },
    &Measurement { id: "expectation-cost", measure: expectations::cost, long: true },
];
