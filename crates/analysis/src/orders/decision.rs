//! The order that is named, or why none is; and its words.

use std::fmt;

use stats::{CrossMoments, Rate};

use super::{Limit, OneStep, Order, runs::Failed};
use crate::number;

/// The order of a scheme, or why no order is named and what would decide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Decision {
    /// The order.
    Order {
        /// A multiple of ½, or an integer for a weak order.
        order: f64,
        /// Whether the points show it. Otherwise they still fall faster, and one step at a smaller
        /// τ shows it.
        shown: bool,
    },
    /// The differences are zero, inside their noise, or rest on too few paths.
    NoDifferences,
    /// The interval is too wide.
    Wide {
        /// About how many times as many paths would do.
        more_paths: f64,
    },
    /// The points fall more slowly than one step says, or on no sum of powers: coarse steps are not
    /// asymptotic yet, or the solution is not smooth.
    NotAsymptotic,
    /// One step shows no order that is a multiple of ½.
    OneStepUnclear,
    /// More than one order explains the points: a term of lower order may be hidden.
    Hidden {
        /// The largest part of the last difference that the lower orders may have.
        share: f64,
    },
    /// More than a tenth of the paths failed: the rest says little about the scheme.
    Failures {
        /// Whether all did.
        all: bool,
        /// The time of the first of these.
        t: f64,
    },
    /// The differences between step sizes are rounding errors: the scheme keeps the function.
    Kept,
    /// The finest step does not resolve the damping ([`DampingResolution`](mc::DampingResolution)).
    Damping {
        /// How far its sums over the steps are from ∫γ.
        defect: f64,
    },
    /// The scheme converges to something else than [`Limit`]'s other solution.
    WrongLimit,
    /// The limit could not be compared.
    LimitUnclear,
}

/// Confidence at which points contradict an order.
const CONTRADICTION: f64 = 0.999;
/// An interval that is wider than the distance of two orders decides nothing.
const WIDEST: f64 = 0.5;
/// The part that terms of lower order may have of the last difference.
const HIDDEN: f64 = 0.1;

/// Rounding errors of a step as a part of the size.
const ROUND_OFF: f64 = 16.0 * f64::EPSILON;

/// What forbids any order: failed paths, or what the sums of the damping lack.
pub fn obstacle(failed: Failed, samples: u64, damping: Option<f64>) -> Option<Decision> {
    let Failed { paths, t } = failed;
    let failures = Decision::Failures { all: paths == samples, t };
    let failures = (10 * paths > samples).then_some(failures);
    failures.or(damping.map(|defect| Decision::Damping { defect }))
}

/// Whether these differences in so many steps are rounding errors of something of this size.
pub fn kept(differences: &CrossMoments, steps: u64, size: f64) -> bool {
    let rounding = ROUND_OFF * steps as f64 * size.abs();
    differences.count() > 1
        && (0..differences.length()).all(|k| {
            let se = differences.covariance_of_means(k, k).max(0.0).sqrt();
            differences.mean(k).abs() + 2.0 * se <= rounding
        })
}

/// The strong order.
pub fn strong(rate: Option<&Rate>, one_step: Option<OneStep>, limit: Limit) -> Decision {
    let rate = match usable(rate, limit) {
        Ok(rate) => rate,
        Err(decision) => return decision,
    };
    let (lo, hi) = rate.interval(CONTRADICTION);
    let Some(one_step) = one_step else {
        return Decision::OneStepUnclear;
    };
    let mut possible = one_step.strong_orders().filter(|&order| order <= hi);
    match (possible.next(), possible.next()) {
        (None, _) => Decision::NotAsymptotic,
        (Some(order), None) => Decision::Order { order, shown: lo <= order },
        (Some(_), Some(_)) => Decision::OneStepUnclear,
    }
}

/// The weak order; `lower_share` is an upper bound of the terms of order below a given one in the
/// last difference, `one_step` the order that the mean error of one step leaves.
pub fn weak(
    rate: Option<&Rate>,
    lower_share: impl Fn(u32) -> Option<f64>,
    one_step: impl Fn() -> Option<f64>,
    limit: Limit,
) -> Decision {
    let rate = match usable(rate, limit) {
        Ok(rate) => rate,
        Err(decision) => return decision,
    };
    let orders: Vec<u32> = (1..=4).filter(|&order| rate.covers(f64::from(order))).collect();
    match orders[..] {
        [order] => match lower_share(order) {
            _ if order == 1 => Decision::Order { order: 1.0, shown: true },
            Some(share) if share <= HIDDEN && one_step().is_none_or(|q| q >= f64::from(order)) => {
                Decision::Order { order: f64::from(order), shown: true }
            }
            share => Decision::Hidden { share: share.unwrap_or(1.0) },
        },
        _ => Decision::NotAsymptotic,
    }
}

/// A rate from which an order may be read.
fn usable(rate: Option<&Rate>, limit: Limit) -> Result<&Rate, Decision> {
    if let Limit::Differs { .. } | Limit::Inconsistent { .. } = limit {
        return Err(Decision::WrongLimit);
    }
    let rate = rate.ok_or(Decision::NoDifferences)?;
    let width = rate.hi - rate.lo;
    if rate.misfits() {
        Err(Decision::NotAsymptotic)
    } else if width.is_nan() || width > WIDEST {
        Err(Decision::Wide { more_paths: (width / WIDEST).powi(2).ceil() })
    } else if !matches!(limit, Limit::Consistent { .. } | Limit::Agrees { .. }) {
        Err(Decision::LimitUnclear)
    } else {
        Ok(rate)
    }
}

impl Decision {
    /// Widens the interval of a rate to the order that is named, or adds the warning that none is.
    /// Returns the order, or the estimate.
    pub fn settle(self, rate: &mut Rate) -> f64 {
        match self {
            Self::Order { order, .. } => {
                (rate.lo, rate.hi) = (rate.lo.min(order), rate.hi.max(order));
                order
            }
            _ => {
                rate.warning = Some(match &rate.warning {
                    Some(warning) => format!("{warning}; {self}"),
                    None => self.to_string(),
                });
                rate.estimate
            }
        }
    }
}

/// The only place that words a decision.
impl fmt::Display for Decision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Order { order, .. } => write!(f, "order {order}"),
            Self::NoDifferences => f.write_str(
                "undecided: the differences between step sizes are inside their noise; more paths \
                 or coarser steps would decide",
            ),
            Self::Wide { more_paths } => {
                write!(f, "undecided: {more_paths:.0} times as many paths would decide")
            }
            Self::NotAsymptotic => f.write_str(
                "undecided: the points follow no order that the scheme can have; finer steps would \
                 decide",
            ),
            Self::OneStepUnclear => f.write_str(
                "undecided: one step as τ → 0 shows no order, or one that leaves two possible",
            ),
            Self::Hidden { share } => write!(
                f,
                "undecided: a term of lower order may have {:.0} % of the last difference; more \
                 paths or finer steps would decide",
                100.0 * share
            ),
            Self::Failures { all: false, .. } => f.write_str(
                "undecided: a tenth of the paths failed, or more; finer steps would decide",
            ),
            Self::Failures { t, .. } => write!(
                f,
                "undecided: all paths failed, the first at t = {}: there the solution itself may \
                 end, and no step size helps; take a shorter final time",
                number(*t)
            ),
            Self::Kept => f.write_str(
                "no order: the errors are at rounding at all step sizes; the scheme keeps this",
            ),
            Self::Damping { defect } => write!(
                f,
                "undecided: the steps do not resolve the damping, whose sums over them differ from \
                 its integral by {defect:.1e}; finer steps would decide"
            ),
            Self::WrongLimit => f.write_str("no order: the scheme converges to something else"),
            Self::LimitUnclear => f.write_str(
                "undecided: the limit could not be compared; finer steps or more paths would \
                 decide",
            ),
        }
    }
}

/// The only place that words an order.
impl fmt::Display for Order {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.decision)?;
        if let Decision::Failures { .. } = self.decision {
            return write!(f, "; {} paths failed", self.failed);
        }
        if let Some(rate) = self.rate.as_ref().filter(|_| self.decision != Decision::Kept) {
            write!(f, "; fitted {:.2} [{:.2}, {:.2}]", rate.estimate, rate.lo, rate.hi)?;
        }
        if let (Decision::Order { shown: false, .. }, Some(step)) = (self.decision, self.one_step) {
            let OneStep { tau, amplification, .. } = step;
            write!(f, "; the points still fall faster, one step at τ = {tau:.0e}")?;
            if amplification > 1.0 {
                write!(f, " with {amplification} times the noise")?;
            }
            f.write_str(" shows the order")?;
        }
        match self.limit {
            Limit::Consistent { defect } => {
                write!(f, "; one step has the coefficients of the equation to {defect:.0e}")
            }
            Limit::Agrees { with, distance } => {
                write!(f, "; its limit differs from that of {with} by at most {distance:.1e}")
            }
            Limit::Inconsistent { defect } => {
                write!(f, "; one step misses the coefficients of the equation by {defect:.0e}")
            }
            Limit::Differs { with, distance } => {
                write!(f, "; its limit is {distance:.1e} from that of {with}")
            }
            Limit::Unclear { with, distance } => {
                write!(f, "; its limit may differ from that of {with} by {distance:.1e}")
            }
            Limit::Unchecked => f.write_str("; no other scheme runs to compare the limit with"),
        }?;
        if self.failed > 0 {
            write!(f, "; {} paths failed and are left out", self.failed)?;
        }
        Ok(())
    }
}
