//! Figures that are not in the paper.

mod exact_references;
mod expectations;
mod levy;
mod truncation_orders;
mod weak_two;

use crate::Experiment;

/// All of them.
pub const SUPPLEMENTS: &[Experiment] = &[
    Experiment::new(&["truncation-orders"], truncation_orders::measure),
    Experiment::new(&["lotka-volterra-exact"], exact_references::lotka_volterra),
    Experiment::new(&["rigid-body-energy-exact"], exact_references::rigid_body),
    Experiment::new(&["spin-pair-levy"], levy::measure),
    Experiment::new(&["rigid-body-expectations"], expectations::measure),
    Experiment::new(&["expectation-cost"], expectations::cost),
    Experiment::new(&["rigid-body-weak-two"], weak_two::measure),
];
