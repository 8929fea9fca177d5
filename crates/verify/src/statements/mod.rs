//! Statements that are measured on their own and not on a panel: those of the paper, and those of
//! `docs/theory.md` on the schemes without iteration.

pub mod exact_conformal;
pub mod local;
pub mod moment_bound;
pub mod solvability;
pub mod truncation;
pub mod without_iteration;

use local::{exact_remainder, remainder_claims};
use schemes::{Sexp, SexpLi, Split};

use crate::*;

/// Statements in the order of the paper, then the others.
pub static STATEMENTS: &[Experiment] = &[
    (&["truncation-moments"], truncation::measure),
    (&["solvability"], solvability::measure),
    (&["exact-conformal"], exact_conformal::measure),
    (&["moment-bound"], moment_bound::measure),
    (&["local-exact"], |conditions| {
        Findings::of(remainder_claims(conditions, "the exact flow", exact_remainder))
    }),
    (&["local-sexp"], |conditions| local::of_scheme(conditions, &Sexp, true)),
    (&["local-sexp-li"], |conditions| {
        let (body, _, y0, _) = local::problem().into_parts();
        local::of_scheme(conditions, &valid(SexpLi::new(&body, y0)), false)
    }),
    (&["local-split"], |conditions| local::of_scheme(conditions, &Split, false)),
    (&["any-increment"], without_iteration::any_increment),
    (&["no-noise"], without_iteration::no_noise),
];
