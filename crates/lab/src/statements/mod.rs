//! The statements of the paper that are measured on their own and not on a panel.

pub mod exact_conformal;
pub mod local;
pub mod moment_bound;
pub mod solvability;
pub mod truncation;

use crate::Experiment;

/// In the order of the paper.
pub const STATEMENTS: &[Experiment] = &[
    Experiment::new(&["truncation-moments"], truncation::measure),
    Experiment::new(&["solvability"], solvability::measure),
    Experiment::new(&["exact-conformal"], exact_conformal::measure),
    Experiment::new(&["moment-bound"], moment_bound::measure),
    Experiment::new(&["local-exact"], local::measure_exact),
    Experiment::new(&["local-sexp"], local::measure_sexp),
];
