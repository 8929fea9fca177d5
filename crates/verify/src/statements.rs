//! The statements of the paper that are measured on their own and not on a panel.

mod exact_conformal;
mod local;
mod moment_bound;
mod solvability;
mod truncation;

use crate::statement::Statement;

/// In the order of the paper.
pub const STATEMENTS: &[Statement] = &[
    Statement { id: "truncation-moments", measure: truncation::measure },
    Statement { id: "solvability", measure: solvability::measure },
    Statement { id: "exact-conformal", measure: exact_conformal::measure },
    Statement { id: "moment-bound", measure: moment_bound::measure },
    Statement { id: "local-exact", measure: local::measure_exact },
    Statement { id: "local-sexp", measure: local::measure_sexp },
];
