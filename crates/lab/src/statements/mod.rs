//! The statements of the paper that are measured on their own and not on a panel.

pub mod exact_conformal;
pub mod local;
pub mod moment_bound;
pub mod solvability;
pub mod truncation;

use crate::experiment::{Experiment, Measurement};

/// In the order of the paper.
pub const STATEMENTS: &[&dyn Experiment] = &[
    &Measurement { id: "truncation-moments", measure: truncation::measure, long: false },
    &Measurement { id: "solvability", measure: solvability::measure, long: false },
    &Measurement { id: "exact-conformal", measure: exact_conformal::measure, long: false },
    &Measurement { id: "moment-bound", measure: moment_bound::measure, long: false },
    &Measurement { id: "local-exact", measure: local::measure_exact, long: false },
    &Measurement { id: "local-sexp", measure: local::measure_sexp, long: false },
];
