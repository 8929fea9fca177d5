//! The order that is named, or why none is; and its words.

use std::fmt;

use stats::{CrossMoments, Rate};

use super::{Limit, OneStep, Order};

/// The order of a scheme, or why no order is named and what would decide.
#[derive(Clone, Debug, PartialEq)]
pub enum Decision {
    /// Order of the scheme.
    Order {
        /// Value of the order: a multiple of ½, or an integer for a weak order.
        order: f64,
        /// Whether the points show the order. Otherwise they still fall faster, and one step at a
        /// smaller τ shows it; or, for a weak order above one, a lower one may hide in a tenth of
        /// the last difference.
        shown: bool,
    },
    /// Differences between step sizes are rounding errors: the scheme conserves the function, or is
    /// exact.
    Kept,
    /// The scheme converges to something else.
    WrongLimit,
    /// No order can be named.
    Undecided {
        /// Reason in words.
        because: String,
        /// Effort that would decide the order.
        more: More,
    },
}

/// Effort that would decide an order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum More {
    /// More paths.
    Paths,
    /// Finer steps.
    Steps,
}

/// Confidence at which points contradict an order.
const CONTRADICTION: f64 = 0.999;
/// An interval that is wider than the distance of two orders decides nothing.
const WIDEST: f64 = 0.5;
/// The part that terms of lower order may have of the last difference.
const HIDDEN: f64 = 0.1;
/// Rounding errors of a step as a part of the size.
const ROUND_OFF: f64 = 16.0 * f64::EPSILON;
/// Exponent of the step size with which rounding errors do not fall; errors have ½ at least.
const FALLS: f64 = 0.25;

pub fn undecided(more: More, because: impl Into<String>) -> Decision {
    Decision::Undecided { because: because.into(), more }
}

/// Rounding errors of `steps` steps of a function of size `size`.
pub fn rounding(steps: u64, size: f64) -> f64 {
    ROUND_OFF * steps as f64 * size.abs()
}

/// Whether differences are rounding errors of this size.
pub fn kept(differences: &CrossMoments, rounding: f64) -> bool {
    differences.count() > 1
        && (0..differences.length())
            .all(|k| differences.mean(k).abs() + 2.0 * differences.standard_error(k) <= rounding)
}

/// Whether a scheme is exact: squared differences are those of rounding errors and do not fall.
pub fn exact(squares: &CrossMoments, rounding: f64, rate: Option<&Rate>, limit: Limit) -> bool {
    matches!(limit, Limit::Agrees { .. } | Limit::Consistent { .. })
        && rate.is_none_or(|rate| rate.estimate < FALLS)
        && kept(squares, rounding * rounding)
}

/// Decides the strong order.
pub fn strong(rate: Option<&Rate>, one_step: Option<OneStep>, limit: Limit) -> Decision {
    let unclear = |orders| {
        undecided(More::Steps, format!("one step as τ → 0 shows {orders} a strong order can have"))
    };
    let rate = match usable(rate, limit) {
        Ok(rate) => rate,
        Err(decision) => return decision,
    };
    let Some(one_step) = one_step else { return unclear("no order that") };
    let (lo, hi) = rate.interval(CONTRADICTION);
    let possible: Vec<f64> = one_step.strong_orders().filter(|&order| order <= hi).collect();
    match possible[..] {
        [] => not_asymptotic(),
        [order] => Decision::Order { order, shown: lo <= order },
        _ => unclear("one of two orders that"),
    }
}

/// Decides the weak order; `lower_share` is an upper bound of the terms of order below a given one
/// in the last difference.
pub fn weak(
    rate: Option<&Rate>,
    lower_share: impl Fn(u32) -> Option<f64>,
    limit: Limit,
) -> Decision {
    let rate = match usable(rate, limit) {
        Ok(rate) => rate,
        Err(decision) => return decision,
    };
    let orders: Vec<u32> = (1..=4).filter(|&order| rate.covers(f64::from(order))).collect();
    let [order] = orders[..] else { return not_asymptotic() };
    let share = if order == 1 { 0.0 } else { lower_share(order).unwrap_or(1.0) };
    if share <= HIDDEN {
        return Decision::Order { order: f64::from(order), shown: order == 1 };
    }
    let percent = 100.0 * share;
    undecided(More::Paths, format!("a lower order may have {percent:.0} % of the last difference"))
}

fn not_asymptotic() -> Decision {
    undecided(More::Steps, "the points follow no order that the scheme can have")
}

/// Rate from which an order may be read, or the decision why there is none.
fn usable(rate: Option<&Rate>, limit: Limit) -> Result<&Rate, Decision> {
    if let Limit::Differs { .. } | Limit::Inconsistent { .. } = limit {
        return Err(Decision::WrongLimit);
    }
    let noise = "the differences between step sizes are inside their noise";
    let rate = rate.ok_or_else(|| undecided(More::Paths, noise))?;
    let times = ((rate.hi - rate.lo) / WIDEST).powi(2).ceil();
    let wide = || format!("the interval is wide, for {times} times as many paths");
    match limit {
        _ if rate.misfits() => Err(not_asymptotic()),
        _ if times.is_nan() || times > 1.0 => Err(undecided(More::Paths, wide())),
        Limit::Consistent { .. } | Limit::Agrees { .. } => Ok(rate),
        _ => Err(undecided(More::Steps, "the limit could not be compared")),
    }
}

/// The only place that words a decision.
impl fmt::Display for Decision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Order { order, .. } => write!(f, "order {order}"),
            Self::Kept => f.write_str("no order: all step sizes give the same up to rounding"),
            Self::WrongLimit => f.write_str("no order: the scheme converges to something else"),
            Self::Undecided { because, more } => {
                let more = if *more == More::Paths { "more paths" } else { "finer steps" };
                write!(f, "undecided: {because}; {more} would decide")
            }
        }
    }
}

/// The only place that words an order.
impl fmt::Display for Order {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { rate, one_step, limit, decision, failed, .. } = self;
        write!(f, "{decision}")?;
        if let Some(rate) = rate.as_ref().filter(|_| *decision != Decision::Kept) {
            write!(f, "; fitted {:.2} [{:.2}, {:.2}]", rate.estimate, rate.lo, rate.hi)?;
        }
        match (decision, one_step) {
            (Decision::Order { shown: false, .. }, Some(OneStep { tau, amplification, .. })) => {
                write!(
                    f,
                    "; shown by one step at τ = {tau:.0e} and {amplification} times the noise"
                )
            }
            (Decision::Order { shown: false, .. }, None) => {
                write!(f, "; a lower order may have a tenth of the last difference")
            }
            _ => Ok(()),
        }?;
        match limit {
            Limit::Consistent { defect } => write!(f, "; right in one step to {defect:.0e}"),
            Limit::Inconsistent { defect } => write!(f, "; wrong in one step by {defect:.0e}"),
            Limit::Agrees { distance } | Limit::Unclear { distance } => {
                write!(f, "; at most {distance:.1e} from the reference")
            }
            Limit::Differs { distance } => write!(f, "; {distance:.1e} from the reference"),
            Limit::Unchecked => write!(f, "; its limit was not compared"),
        }?;
        if *failed > 0 {
            write!(f, "; {failed} paths failed and are left out")?;
        }
        Ok(())
    }
}
