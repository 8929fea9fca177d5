//! When an order is said to hold.

use super::quantile;
use crate::results::{Rate, Verdict};

/// Confidence at which verdicts are given: one run gives some thirty verdicts, and a false alarm fails it.
const VERDICT_CONFIDENCE: f64 = 0.999;
/// Orders are multiples of ½; this is half the distance between neighbours.
pub const ORDER_MARGIN: f64 = 0.25;

/// Whether a fitted order is `order`.
///
/// The interval is widened about its estimate from [`Rate::confidence`] to 99.9 %. The order holds when the widened
/// interval contains it and lies within [`ORDER_MARGIN`] of it, so that no other multiple of ½ is as near; it is
/// refuted when the widened interval lies farther away than that; anything else, or no fit, is undecided.
#[must_use]
pub fn order_verdict(rate: Option<&Rate>, order: f64) -> Verdict {
    let Some(rate) = rate else { return Verdict::Undecided };
    let widening = quantile(VERDICT_CONFIDENCE) / quantile(rate.confidence);
    let lo = rate.estimate - widening * (rate.estimate - rate.lo);
    let hi = rate.estimate + widening * (rate.hi - rate.estimate);
    if lo > order + ORDER_MARGIN || hi < order - ORDER_MARGIN {
        Verdict::Refuted
    } else if lo <= order && order <= hi && lo > order - ORDER_MARGIN && hi < order + ORDER_MARGIN {
        Verdict::Holds
    } else {
        Verdict::Undecided
    }
}
