//! Figures that are not in the paper.

mod exact_references;
mod expectations;
pub(crate) mod levy;
mod truncation_orders;

pub use expectations::expectation_claims;

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
    Supplement { id: "spin-pair-levy", run: levy::spin_pair },
    Supplement { id: "rigid-body-expectations", run: expectations::expectations },
    Supplement { id: "expectation-cost", run: expectations::cost },
];
