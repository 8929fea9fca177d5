//! Figures that are not in the paper.

mod exact_references;
mod expectations;
mod levy;
mod truncation_orders;
mod weak_two;

pub use expectations::KOLMOGOROV;

use crate::*;

/// Supplements: experiments that make figures that are not in the paper.
pub const SUPPLEMENTS: &[Experiment] = &[
    (&["truncation-orders"], truncation_orders::measure),
    (&["lotka-volterra-exact"], exact_references::lotka_volterra),
    (&["rigid-body-energy-exact"], exact_references::rigid_body),
    (&["spin-pair-levy"], levy::measure),
    (&["rigid-body-expectations"], expectations::measure),
    (&["expectation-cost"], expectations::cost),
    (&["rigid-body-weak-two"], weak_two::measure),
];
