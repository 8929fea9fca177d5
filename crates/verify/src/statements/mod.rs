//! Statements that are measured on their own and not on a panel: those of the paper, and what
//! `docs/theory.md` says of the schemes without iteration.

pub mod exact_conformal;
pub mod local;
pub mod moment_bound;
pub mod solvability;
pub mod truncation;
pub mod without_iteration;

use schemes::{Sexp, Split};

use crate::Experiment;

/// In the order of the paper, then the others.
pub const STATEMENTS: &[Experiment] = &[
    Experiment::new(&["truncation-moments"], truncation::measure),
    Experiment::new(&["solvability"], solvability::measure),
    Experiment::new(&["exact-conformal"], exact_conformal::measure),
    Experiment::new(&["moment-bound"], moment_bound::measure),
    Experiment::new(&["local-exact"], local::measure_exact),
    Experiment::new(&["local-sexp"], |conditions| local::of_scheme(conditions, &Sexp, true)),
    Experiment::new(&["local-sexp-li"], local::measure_sexp_li),
    Experiment::new(&["local-split"], |conditions| local::of_scheme(conditions, &Split, false)),
    Experiment::new(&["any-increment"], without_iteration::any_increment),
    Experiment::new(&["no-noise"], without_iteration::no_noise),
];
