//! The statements of the paper that are measured on their own and not on a panel.

pub(crate) mod exact_conformal;
pub(crate) mod local;
pub(crate) mod moment_bound;
pub(crate) mod solvability;
pub(crate) mod truncation;

use crate::experiment::Statement;

/// In the order of the paper.
pub const STATEMENTS: &[Statement] = &[
    Statement { id: "truncation-moments", measure: truncation::measure },
    Statement { id: "solvability", measure: solvability::measure },
    Statement { id: "exact-conformal", measure: exact_conformal::measure },
    Statement { id: "moment-bound", measure: moment_bound::measure },
    Statement { id: "local-exact", measure: local::measure_exact },
    Statement { id: "local-sexp", measure: local::measure_sexp },
];
