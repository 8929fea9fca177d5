//! Figures that are not in the paper.

mod exact_references;
mod expectations;
mod levy;
mod truncation_orders;
mod weak_two;

pub use expectations::KOLMOGOROV;

use crate::*;
use exact_references::compare;

/// Supplements: experiments that make figures that are not in the paper.
pub static SUPPLEMENTS: &[Experiment] = &[
    (&["truncation-orders"], truncation_orders::measure),
    (&["lotka-volterra-exact"], |conditions| {
        let title = "Lotka–Volterra against its exact solution: strong convergence";
        compare(conditions, [title, VOLTERRA], &paper::lotka_volterra_1_1())
    }),
    (&["rigid-body-energy-exact"], |conditions| {
        let title = "Rigid body with noise H₀ against its exact solution: strong convergence";
        compare(conditions, [title, BODY_ENERGY], &paper::rigid_body_energy(1.0))
    }),
    (&["spin-pair-levy"], levy::measure),
    (&["rigid-body-expectations"], expectations::measure),
    (&["expectation-cost"], expectations::cost),
    (&["rigid-body-weak-two"], weak_two::measure),
];
