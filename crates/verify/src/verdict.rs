//! Verdicts, and the rule by which an order holds.

use serde::Serialize;

use crate::*;

/// The answer to a statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The measurement supports the statement.
    Holds,
    /// The measurement contradicts the statement.
    Refuted,
    /// The measurement cannot decide; never counted as a pass.
    Undecided,
}

/// Confidence of verdicts: one run gives some sixty verdicts about orders, and a false alarm fails
/// the run.
const VERDICT_CONFIDENCE: f64 = 0.999;
/// Half the distance between neighbouring orders, which are multiples of ½.
pub const ORDER_MARGIN: f64 = 0.25;

/// Judges whether a fitted order is `order`, or at least `order`: an error that is bounded by
/// Cτ^`order` may have a higher order.
///
/// The interval is widened about its estimate from [`Rate::confidence`] to 99.9 %. The order holds
/// if the widened interval contains it and lies within [`ORDER_MARGIN`] of it, so that no other
/// multiple of ½ is as near; it is refuted if the widened interval lies farther away than that;
/// anything else, no fit, or a model that its residuals reject, is undecided. Where it is
/// `one_sided` nothing is too large.
pub fn order_verdict(rate: Option<&Rate>, order: f64, one_sided: bool) -> Verdict {
    let Some(rate) = rate.filter(|rate| !rate.misfits()) else { return Verdict::Undecided };
    let (lo, hi) = rate.interval(VERDICT_CONFIDENCE);
    let (least, most) = (order - ORDER_MARGIN, order + ORDER_MARGIN);
    let not_above = one_sided || lo <= order && hi < most;
    if hi < least || !one_sided && lo > most {
        Verdict::Refuted
    } else if not_above && hi >= order && lo > least {
        Verdict::Holds
    } else {
        Verdict::Undecided
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_hold_are_refuted_or_undecided() {
        // At the confidence of verdicts already, so nothing is widened.
        let rate = |estimate: f64, lo, hi| Rate {
            estimate,
            lo,
            hi,
            confidence: VERDICT_CONFIDENCE,
            ..Rate::default()
        };
        let both = |rate: &Rate, order| {
            [false, true].map(|one_sided| order_verdict(Some(rate), order, one_sided))
        };
        use Verdict::{Holds, Refuted, Undecided};
        let half = rate(0.5, 0.45, 0.55);
        assert_eq!(both(&half, 0.5), [Holds, Holds]);
        assert_eq!(both(&half, 1.0), [Refuted, Refuted]);
        assert_eq!(both(&half, 0.0), [Refuted, Holds]);
        assert_eq!(both(&rate(0.5, 0.1, 0.9), 0.5), [Undecided, Undecided]);
        // Precise, near the order, and yet not it.
        assert_eq!(both(&rate(0.55, 0.54, 0.56), 0.5), [Undecided, Holds]);
        assert_eq!(both(&rate(0.45, 0.44, 0.46), 0.5), [Undecided, Undecided]);
        // A model that its residuals reject.
        let misfit = Rate { p_value: Some(1e-6), ..half.clone() };
        assert_eq!(both(&misfit, 0.5), [Undecided, Undecided]);
        assert_eq!(order_verdict(None, 0.5, false), Undecided);
        // A 95 % interval is widened by the ratio of the normal quantiles, 3.29/1.96.
        let narrow = Rate { confidence: 0.95, ..rate(0.5, 0.36, 0.64) };
        assert_eq!(both(&narrow, 0.5), [Holds, Holds]);
        let wide = Rate { confidence: 0.95, ..rate(0.5, 0.34, 0.66) };
        assert_eq!(both(&wide, 0.5), [Undecided, Undecided]);
    }
}
