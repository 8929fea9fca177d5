//! Figures that are not in the paper.

mod exact_references;
mod expectations;
mod levy;
mod truncation_orders;
mod weak_two;

pub use expectations::expectation_claims;

use crate::Experiment;

/// All of them.
pub const SUPPLEMENTS: &[Experiment] = &[
    Experiment::new(&["truncation-orders"], truncation_orders::measure).in_parts(),
    Experiment::new(&["lotka-volterra-exact"], exact_references::lotka_volterra).long().in_parts(),
    Experiment::new(&["rigid-body-energy-exact"], exact_references::rigid_body).long().in_parts(),
    Experiment::new(&["spin-pair-levy"], levy::measure).long().in_parts(),
    Experiment::new(&["rigid-body-expectations"], expectations::measure).long(),
    Experiment::new(&["expectation-cost"], expectations::cost).long(),
    Experiment::new(&["rigid-body-weak-two"], weak_two::measure).long(),
];
