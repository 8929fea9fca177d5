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
//!    paths agree with those of a reference scheme or of an exact solution. A scheme that converges
//!    to something else has differences with an order, too;
//! 4. the steps resolve the damping ([`SeenDamping`](mc::SeenDamping)).
//!
//! Otherwise [`Order::decision`] says why no order is named, and what would decide.

mod consistency;
mod decision;
mod errors;
mod limit;
mod one_step;
mod runs;
mod step_sizes;
mod strong;
#[cfg(test)]
mod tests;
mod visits;
mod weak;
mod within;

use mc::{LadderError, Observable, TimeChange};
use schemes::Scheme;
use stats::{Point, Rate};
use systems::{Damping, PoissonSystem, Problem};

use crate::results::Evidence;

pub(crate) use consistency::Consistency;
pub use decision::Decision;
pub use limit::{Limit, wrong_limit};
pub use one_step::OneStep;
pub use runs::exact_mean;
pub use step_sizes::StepSizes;
pub use strong::{strong_order, strong_order_against};
pub use weak::weak_order;
pub use within::{strong_order_within, weak_order_within};

/// The order of one scheme, with what it rests on.
///
/// [`Display`](std::fmt::Display) words it.
#[derive(Clone, Debug)]
pub struct Order {
    /// Error against the limit at each of the `levels` step sizes, coarsest first, with a 95 %
    /// interval. The error that is left at the finest step is extrapolated and widens the interval.
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
    /// Paths that were left out of every number here, since some run of theirs failed.
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

    /// The measurement as evidence for this order.
    pub fn evidence(self, order: f64) -> Evidence {
        let wrong_limit = match self.limit {
            Limit::Differs { distance: wrong, .. } | Limit::Inconsistent { defect: wrong } => {
                Some(wrong)
            }
            _ => None,
        };
        Evidence::Order { order, one_sided: false, rate: self.rate, wrong_limit }
    }
}

/// What the limit of a scheme is compared with, path by path.
pub enum ReferenceSolution<'a, S, const D: usize, const M: usize> {
    /// The coefficients of the equation, in single steps as τ → 0, and the paths of `heun`, or of
    /// `midpoint` where that fails or is the scheme itself.
    Independent,
    /// This scheme.
    Scheme(&'a dyn Scheme<S, D, M>),
    /// The exact solution. Errors of points are measured against it.
    Exact(Exact<'a, D>),
}

impl<'a, S, const D: usize, const M: usize> ReferenceSolution<'a, S, D, M> {
    fn exact(&self) -> Option<Exact<'a, D>> {
        match *self {
            Self::Exact(exact) => Some(exact),
            _ => None,
        }
    }
}

/// An exact solution at the final time, a function of a random time ([`TimeChange`]).
#[derive(Clone, Copy)]
pub struct Exact<'a, const D: usize> {
    /// The random time, carried along each path.
    pub time_change: &'a dyn TimeChange,
    /// y(T) as a function of the random time at T.
    pub solution: &'a (dyn Fn(f64) -> [f64; D] + Sync),
}

/// What an order is measured of: the states themselves, or a test function.
#[derive(Clone, Copy)]
enum Measure<const D: usize> {
    Strong,
    Weak(Observable<D>),
}

/// Compares single steps of the scheme with the coefficients of the equation as τ → 0, at states
/// that its paths visit.
pub(crate) fn single_steps<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    sizes: &StepSizes,
) -> Result<Consistency, LadderError> {
    let visits = visits::visits(scheme, problem, sizes)?;
    Ok(consistency::consistency(scheme, problem, sizes, &visits, false))
}
