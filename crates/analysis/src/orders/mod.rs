//! Orders of any scheme on any problem.
//!
//! [`StepSizes`] says which step sizes, how many paths and which noise. The scheme runs at all of
//! them on the same noise. The order is fitted to the differences y_τ − y_{τ/2} of successive step
//! sizes, so that no reference with an error of its own is in it, and named only if
//!
//! 1. the points show convergence that is no slower;
//! 2. for a strong order: one step as τ → 0 has the order that belongs to it ([`OneStep`]). A small
//!    term of low order, which does not yet show at the step sizes measured, is found there;
//! 3. the limit is right ([`Limit`]): one step has the coefficients of the equation as τ → 0, or
//!    paths agree with an exact solution. A scheme that converges to something else has differences
//!    with an order, too;
//! 4. the steps resolve the damping ([`DampingResolution`](mc::DampingResolution)) and H(t)
//!    ([`DriveResolution`](mc::DriveResolution)).
//!
//! Otherwise [`Order::decision`] says why no order is named, and what would decide.
//!
//! A scheme and its problem are a [`Setup`](mc::Setup), of any dimension and with any number of
//! noises.

mod consistency;
mod decision;
mod limit;
mod one_step;
mod order;
mod referee;
mod runs;
mod step_sizes;
#[cfg(test)]
mod tests;

use mc::{LadderError, Setup};
use stats::{Point, Rate};

pub use decision::{Decision, More};
pub use limit::{Limit, wrong_limit};
pub use one_step::OneStep;
pub use order::{Exact, squared_distance, strong_order, weak_order};
pub use referee::*;
pub(crate) use runs::{kept, state};
pub use step_sizes::StepSizes;

/// Order of one scheme, with the measurements behind it.
///
/// [`Display`](std::fmt::Display) words it.
#[derive(Clone, Debug)]
pub struct Order {
    /// Points that the order is fitted to, coarsest step size first, with intervals of 95 %:
    /// differences y_τ − y_{τ/2} in the root mean square or in the mean of the function, or errors
    /// against an exact solution.
    pub points: Vec<Point>,
    /// The fitted order; `None` if the differences are zero or inside their noise. Its interval
    /// reaches to the order that is named.
    pub rate: Option<Rate>,
    /// The order of the error of one step as τ → 0, where it was measured and is clear.
    pub one_step: Option<OneStep>,
    /// Whether the scheme converges to the right limit.
    pub limit: Limit,
    /// The order, or why there is none.
    pub decision: Decision,
    /// Number of paths left out of every number here, since some run of theirs failed.
    pub failed: u64,
}

impl Order {
    /// The order, if one is named.
    pub fn order(&self) -> Option<f64> {
        match self.decision {
            Decision::Order { order, .. } => Some(order),
            _ => None,
        }
    }
}

/// Compares single steps of the scheme with the coefficients of the equation as τ → 0, at states
/// that its paths visit; returns the first failure, if one of the paths fails.
pub(crate) fn single_steps(
    setup: &Setup<'_>,
    sizes: &StepSizes,
) -> Result<Result<Limit, String>, LadderError> {
    let (visits, failure) = runs::visits(setup, sizes, consistency::VISITS as u64)?;
    Ok(match failure {
        Some(failure) => Err(failure.to_string()),
        None => Ok(consistency::consistency(setup, sizes, &visits, false)),
    })
}
