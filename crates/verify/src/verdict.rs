//! Verdicts, and when an order is said to hold.

use serde::{Deserialize, Serialize};
use stats::{Rate, misfits, normal_quantile, student_quantile};

/// The answer to a statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The measurement supports the statement.
    Holds,
    /// The measurement contradicts the statement.
    Refuted,
    /// The measurement cannot decide; never counted as a pass.
    Undecided,
}

/// Confidence at which verdicts are given: one run gives some sixty verdicts about orders, and a
/// false alarm fails it.
const VERDICT_CONFIDENCE: f64 = 0.999;
/// Orders are multiples of ½; this is half the distance between neighbours.
pub const ORDER_MARGIN: f64 = 0.25;

/// Whether a fitted order is `order`.
///
/// The interval is widened about its estimate from [`Rate::confidence`] to 99.9 %. The order holds
/// when the widened interval contains it and lies within [`ORDER_MARGIN`] of it, so that no other
/// multiple of ½ is as near; it is refuted when the widened interval lies farther away than that;
/// anything else, no fit, or a model that its residuals contradict, is undecided.
#[must_use]
pub fn order_verdict(rate: Option<&Rate>, order: f64) -> Verdict {
    let Some((lo, hi)) = rate.filter(|rate| !misfits(rate)).map(widened) else {
        return Verdict::Undecided;
    };
    if lo > order + ORDER_MARGIN || hi < order - ORDER_MARGIN {
        Verdict::Refuted
    } else if lo <= order && order <= hi && lo > order - ORDER_MARGIN && hi < order + ORDER_MARGIN {
        Verdict::Holds
    } else {
        Verdict::Undecided
    }
}

/// Whether an error is bounded by Cτ^`order`, which a higher order is, too.
///
/// As [`order_verdict`], but one-sided: the bound holds when the widened interval reaches `order`
/// or lies above it and stays above `order` − [`ORDER_MARGIN`]; it is refuted when the widened
/// interval lies below that.
#[must_use]
pub fn bound_verdict(rate: Option<&Rate>, order: f64) -> Verdict {
    let Some((lo, hi)) = rate.filter(|rate| !misfits(rate)).map(widened) else {
        return Verdict::Undecided;
    };
    if hi < order - ORDER_MARGIN {
        Verdict::Refuted
    } else if hi >= order && lo > order - ORDER_MARGIN {
        Verdict::Holds
    } else {
        Verdict::Undecided
    }
}

/// The interval at [`VERDICT_CONFIDENCE`].
fn widened(rate: &Rate) -> (f64, f64) {
    let quantile = |confidence| {
        rate.student_degrees
            .map_or(normal_quantile(confidence), |degrees| student_quantile(degrees, confidence))
    };
    let widening = quantile(VERDICT_CONFIDENCE) / quantile(rate.confidence);
    (
        rate.estimate - widening * (rate.estimate - rate.lo),
        rate.estimate + widening * (rate.hi - rate.estimate),
    )
}
