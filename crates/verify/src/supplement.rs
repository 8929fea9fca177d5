//! Figures that are not in the paper.

mod exact_references;
mod truncation_orders;

use crate::experiment::{Context, Yield};

/// A figure that is not in the paper.
pub struct Supplement {
    /// Its id.
    pub id: &'static str,
    /// Runs it.
    pub(crate) run: fn(&Context<'_>) -> Yield,
}

/// All of them.
pub const SUPPLEMENTS: &[Supplement] = &[
    Supplement { id: "truncation-orders", run: truncation_orders::run },
    Supplement { id: "lotka-volterra-exact", run: exact_references::lotka_volterra },
    Supplement { id: "rigid-body-energy-exact", run: exact_references::rigid_body },
];
