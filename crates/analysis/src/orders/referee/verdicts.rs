//! Verdicts on what is claimed of a solver.

use std::fmt;

use serde::Serialize;

use super::{
    super::{Decision, Limit, Order},
    Judged, Law,
};

/// Claims about a solver, to be confirmed or refuted.
#[derive(Clone, Debug, Default)]
pub struct Claims {
    /// Claimed strong order.
    pub strong: Option<f64>,
    /// Claimed weak order.
    pub weak: Option<f64>,
    /// Whether the solver is claimed to conserve the laws of the problem.
    pub keeps: bool,
    /// Whether the solver is the same map in each step, so that single steps show its order.
    pub same_step: bool,
}

/// Verdict on a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// The claim holds: an order is at least the claimed one.
    Confirmed,
    /// The claim is wrong: an order is lower, or the limit is another.
    Refuted,
    /// Undecided: the measurement neither confirms nor refutes the claim.
    #[serde(rename = "cannot tell")]
    CannotTell,
}

/// Properties of a solver and verdicts on its claims; [`Display`](fmt::Display) has a line for
/// each.
#[derive(Clone, Debug, Serialize)]
#[serde(transparent)]
pub struct Verdicts(Vec<Line>);

/// Property of a solver.
#[derive(Clone, Debug, Serialize)]
struct Line {
    what: String,
    claimed: Option<String>,
    verdict: Option<Verdict>,
    words: String,
}

/// The name of the verdict in JSON.
impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}

impl fmt::Display for Verdicts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for Line { what, claimed, verdict, words } in &self.0 {
            f.write_str(what)?;
            if let Some((claimed, verdict)) = claimed.as_ref().zip(verdict.as_ref()) {
                write!(f, " {claimed}: {verdict}")?;
            }
            writeln!(f, ": {words}")?;
        }
        Ok(())
    }
}

impl Claims {
    /// Judges the claims by what the states of the solver show.
    pub fn judge(&self, found: &Judged) -> Verdicts {
        let Judged { strong, weak, laws, solves, own_noise, .. } = found;
        let mut lines = Vec::new();
        let mut say = |what: String, claim: Option<(String, Verdict)>, words: String| {
            let (claimed, verdict) = claim.unzip();
            lines.push(Line { what, claimed, verdict, words });
        };
        let verdict = self.strong.map(|claimed| match own_noise {
            true => Verdict::Refuted,
            false => strong.is_strongly(claimed, self.same_step),
        });
        let words = match (&strong.decision, solves) {
            _ if *own_noise => {
                "the same increments give other states: it draws noise of its own".into()
            }
            (Decision::Kept, _) => {
                "exact: all step sizes give the same states up to rounding".into()
            }
            (_, Some(solves)) => format!("it solves {solves}; {strong}"),
            (Decision::WrongLimit, None) => {
                format!("it solves another equation than that of `scene.inspect()`; {strong}")
            }
            (Decision::Undecided { .. }, _) if verdict == Some(Verdict::Confirmed) => {
                format!("no less; by itself {strong}")
            }
            _ => strong.to_string(),
        };
        let claim = |claimed: f64| claimed.to_string();
        say("strong order".into(), self.strong.map(claim).zip(verdict), words);
        for (name, order) in weak {
            let mut verdict = self.weak.map(|claimed| order.is_weakly(claimed));
            let mut words = order.to_string();
            let implies = |claimed| !own_noise && strong.implies_weakly(order, claimed);
            if verdict == Some(Verdict::CannotTell) && self.weak.is_some_and(implies) {
                verdict = Some(Verdict::Confirmed);
                words = format!(
                    "implied by the strong order, for steps that are smooth in τ and ΔW; by \
                     itself {order}"
                );
            }
            say(format!("weak order of E[{name}]"), self.weak.map(claim).zip(verdict), words);
        }
        for Law { law, defect, rounding } in laws {
            let (verdict, words) = if defect <= rounding {
                (Verdict::Confirmed, format!("kept to {defect:.0e}, which is rounding"))
            } else {
                let words = format!("defect {defect:.1e}, rounding would be {rounding:.0e}");
                (Verdict::Refuted, words)
            };
            say(format!("law {law}"), self.keeps.then(|| ("kept".into(), verdict)), words);
        }
        Verdicts(lines)
    }
}

/// Confidence at which points contradict a claim.
const CONTRADICTION: f64 = 0.999;
/// Distance by which the upper end of the interval must be below a claim where no order is named:
/// more than half the distance of two orders.
const BELOW: f64 = 0.3;

impl Order {
    /// Verdict on the claim that the weak order is at least `claimed`. Only an order that is named,
    /// or another limit, refutes it: where an error changes its sign, points follow any power.
    pub fn is_weakly(&self, claimed: f64) -> Verdict {
        match self.decision {
            Decision::Order { order, .. } if order >= claimed => Verdict::Confirmed,
            Decision::Kept => Verdict::Confirmed,
            Decision::Order { .. } | Decision::WrongLimit => Verdict::Refuted,
            Decision::Undecided { .. } => Verdict::CannotTell,
        }
    }

    /// Verdict on the claim that the strong order is at least `claimed`. A lower one that single
    /// steps show and points do not contradict counts if all steps are the `same` map. Where no
    /// order is named, points that are clearly lower refute the claim, and single steps of which
    /// every possible order is high enough confirm it.
    pub fn is_strongly(&self, claimed: f64, same: bool) -> Verdict {
        let reaches = self.reaches().unwrap_or(f64::NAN);
        let possible = self.one_step.iter().flat_map(|step| step.strong_orders());
        let least = possible.reduce(f64::min).unwrap_or(f64::NAN);
        let agrees = matches!(self.limit, Limit::Agrees { .. });
        match (self.is_weakly(claimed), &self.decision) {
            (Verdict::Refuted, Decision::Order { .. }) if !same && reaches >= claimed => {
                Verdict::CannotTell
            }
            (Verdict::CannotTell, _) if reaches < claimed - BELOW => Verdict::Refuted,
            (Verdict::CannotTell, _) if agrees && reaches >= claimed && least >= claimed => {
                Verdict::Confirmed
            }
            (verdict, _) => verdict,
        }
    }

    /// Whether a strong order shows the weak one that was claimed: errors of means are at most
    /// those of paths, and those of a step that is smooth in τ and in Gaussian increments have
    /// integer powers of τ, so that the order is that of paths rounded up. Not if the points of the
    /// `means` contradict it.
    pub fn implies_weakly(&self, means: &Self, claimed: f64) -> bool {
        let named = match self.decision {
            Decision::Order { order, .. } => order > 0.0 && order.ceil() >= claimed,
            _ => self.decision == Decision::Kept,
        };
        named && means.reaches().is_none_or(|order| order >= claimed)
    }

    /// The largest order that the points do not contradict, where they follow one.
    fn reaches(&self) -> Option<f64> {
        let rate = self.rate.as_ref().filter(|rate| !rate.misfits());
        rate.map(|rate| rate.interval(CONTRADICTION).1)
    }
}

#[cfg(test)]
mod tests {
    use stats::Rate;

    use super::*;
    use crate::orders::{More, OneStep, decision::undecided};

    fn order(decision: Decision, hi: f64, one_step: f64) -> Order {
        // At the confidence of a contradiction already, so that nothing is widened.
        let rate = Rate { estimate: 0.5, lo: 0.4, hi, confidence: 0.999, ..Rate::default() };
        let one_step = Some(OneStep { order: one_step, tau: 1e-6, amplification: 1.0, mean: None });
        let limit = Limit::Agrees { distance: 1e-3 };
        Order { points: Vec::new(), rate: Some(rate), one_step, limit, decision, failed: 0 }
    }

    #[test]
    fn orders_that_are_named_confirm_and_refute() {
        let named = |order: f64| Decision::Order { order, shown: true };
        let of = |decision, claimed| order(decision, 0.6, 1.0).is_weakly(claimed);
        assert_eq!(of(named(1.0), 1.0), Verdict::Confirmed);
        assert_eq!(of(named(1.0), 2.0), Verdict::Refuted);
        assert_eq!(of(Decision::Kept, 2.0), Verdict::Confirmed);
        assert_eq!(of(Decision::WrongLimit, 0.5), Verdict::Refuted);
        // Points of means alone refute nothing.
        assert_eq!(of(undecided(More::Steps, ""), 2.0), Verdict::CannotTell);
        // Points reach 1.1, single steps have ½: they count if all steps are the same.
        let half = |same| order(named(0.5), 1.1, 1.0).is_strongly(1.0, same);
        assert_eq!((half(true), half(false)), (Verdict::Refuted, Verdict::CannotTell));
        assert_eq!(order(named(0.5), 0.9, 1.0).is_strongly(1.0, false), Verdict::Refuted);
    }

    #[test]
    fn without_a_named_order_points_refute_and_single_steps_confirm() {
        let of = |hi, one_step, claimed| {
            order(undecided(More::Steps, ""), hi, one_step).is_strongly(claimed, true)
        };
        assert_eq!(
            (of(0.69, 2.0, 1.0), of(0.71, 2.0, 1.0)),
            (Verdict::Refuted, Verdict::CannotTell)
        );
        // Of single steps of order two, one and 1½ are possible.
        assert_eq!(
            (of(1.4, 2.0, 1.0), of(1.6, 2.0, 1.5)),
            (Verdict::Confirmed, Verdict::CannotTell)
        );
        let mut other = order(undecided(More::Steps, ""), 1.4, 2.0);
        other.limit = Limit::Unclear { distance: 1.0 };
        assert_eq!(other.is_strongly(1.0, true), Verdict::CannotTell);
    }

    #[test]
    fn a_strong_order_implies_a_weak_one_of_one() {
        let means = |hi| order(undecided(More::Paths, ""), hi, 1.0);
        let of = |order_: f64, claimed| {
            let strong = order(Decision::Order { order: order_, shown: true }, 1.0, 1.0);
            // Means of half the order contradict it.
            assert!(!strong.implies_weakly(&means(0.5 * claimed), claimed));
            strong.implies_weakly(&means(claimed), claimed)
        };
        assert!(of(0.5, 1.0) && of(1.0, 1.0) && !of(0.5, 2.0) && !of(0.0, 1.0) && of(2.0, 2.0));
        let none = Order { rate: None, ..means(0.5) };
        assert!(order(Decision::Kept, 1.0, 1.0).implies_weakly(&none, 2.0));
        assert!(!order(Decision::WrongLimit, 1.0, 1.0).implies_weakly(&means(2.0), 1.0));
    }
}
