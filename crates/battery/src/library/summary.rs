//! Counts of answers, and how many may be false.

use serde::{Deserialize, Serialize};
use statrs::distribution::{Binomial, DiscreteCDF};

use super::{Answer, Entry, OldRule, Question, Stated};

/// The answers to one entry.
#[derive(Debug, PartialEq)]
pub struct Row {
    /// What sort of problem it is.
    pub kind: &'static str,
    /// The problem.
    pub name: String,
    /// What is asked.
    pub question: Question,
    /// The counts.
    pub total: Total,
    /// Those of the old rule.
    pub old: Option<(OldRule, Total)>,
    /// A reason for an undecided answer.
    pub reason: Option<String>,
}

/// Counts of answers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Total {
    /// Answers.
    pub asked: u64,
    /// Those that state something.
    pub stated: u64,
    /// Those that state something false.
    pub missed: u64,
    /// Path-steps of all.
    pub cost: u64,
    /// Sum of the half-widths of the stated intervals.
    pub half_widths: f64,
    /// Sum of the squares of the distances of their middles from the truth.
    pub squares: f64,
}

impl Total {
    fn of_one(entry: &Entry, stated: &Stated, cost: u64) -> Self {
        let (half_widths, squares) = match (stated, entry.truth) {
            (&Stated::Interval(lo, hi), Some(truth)) => {
                let error = 0.5 * (lo + hi) - truth;
                (0.5 * (hi - lo), error * error)
            }
            _ => (0.0, 0.0),
        };
        let [stated, missed] = [stated.decided(), stated.misses(entry.truth)].map(u64::from);
        Self { asked: 1, stated, missed, cost, half_widths, squares }
    }

    fn plus(self, more: Self) -> Self {
        Self {
            asked: self.asked + more.asked,
            stated: self.stated + more.stated,
            missed: self.missed + more.missed,
            cost: self.cost + more.cost,
            half_widths: self.half_widths + more.half_widths,
            squares: self.squares + more.squares,
        }
    }

    /// Part of the stated answers that are false.
    pub fn missed_share(&self) -> f64 {
        self.missed as f64 / self.stated.max(1) as f64
    }

    /// The mean half-width over 1.96 times the root mean square of the errors: one for intervals of
    /// normal errors without bias.
    pub fn relative_width(&self) -> f64 {
        let n = self.stated as f64;
        self.half_widths / n / (1.96 * (self.squares / n).sqrt())
    }

    /// Part of the answers that state nothing.
    pub fn undecided_share(&self) -> f64 {
        (self.asked - self.stated) as f64 / self.asked.max(1) as f64
    }

    /// Whether the share of false answers is above `tolerated`: with that share, so many among the
    /// stated ones have a probability of at most `chance`.
    pub fn refuted(&self, tolerated: f64, chance: f64) -> bool {
        self.missed > 0 && at_least(self.missed, self.stated, tolerated) <= chance
    }
}

/// P(X ≥ k) for a binomial X of n trials, k ≥ 1.
fn at_least(k: u64, n: u64, p: f64) -> f64 {
    Binomial::new(p, n).map_or(1.0, |law| law.sf(k - 1))
}

/// What is counted of an answer.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Counted {
    total: Total,
    old: Option<Total>,
    reason: Option<String>,
}

impl Counted {
    pub fn new(entry: &Entry, answer: &Answer) -> Self {
        let reason = match &answer.stated {
            Stated::Undecided(reason) => Some(reason.clone()),
            _ => None,
        };
        let old = answer.old.as_ref().map(|old| Total::of_one(entry, old, 0));
        Self { total: Total::of_one(entry, &answer.stated, answer.cost), old, reason }
    }
}

impl Row {
    pub(super) fn new<'a>(entry: &Entry, answers: impl Iterator<Item = &'a Counted>) -> Self {
        let (mut total, mut old, mut reason) = (Total::default(), Total::default(), None);
        for counted in answers {
            total = total.plus(counted.total);
            old = old.plus(counted.old.unwrap_or_default());
            reason = reason.or_else(|| counted.reason.clone());
        }
        Self {
            kind: entry.kind,
            name: entry.name.clone(),
            question: entry.question,
            total,
            old: entry.old_rule.map(|rule| (rule, old)),
            reason,
        }
    }
}

/// Totals by question and kind, in the order of the rows.
pub fn by_kind(rows: &[Row]) -> Vec<(Question, &'static str, Total)> {
    let mut totals: Vec<(Question, &'static str, Total)> = Vec::new();
    for row in rows {
        match totals.iter_mut().find(|(q, kind, _)| (*q, *kind) == (row.question, row.kind)) {
            Some((.., total)) => *total = total.plus(row.total),
            None => totals.push((row.question, row.kind, row.total)),
        }
    }
    totals
}

/// Totals of each old rule on the entries it is the twin of, with those of the rule in use there.
pub fn by_old_rule(rows: &[Row]) -> Vec<(OldRule, Total, Total)> {
    let of = |rule: OldRule| {
        let rows =
            rows.iter().filter_map(|row| row.old.map(|(other, old)| (other, old, row.total)));
        let rows = rows.filter(|(other, ..)| *other == rule);
        rows.fold((rule, Total::default(), Total::default()), |(rule, old, new), (_, a, b)| {
            (rule, old.plus(a), new.plus(b))
        })
    };
    OldRule::ALL.map(of).into_iter().filter(|(_, old, _)| old.asked > 0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn binomial_tails() {
        assert!((at_least(1, 10, 0.07) - (1.0 - 0.93f64.powi(10))).abs() < 1e-15);
        assert!((at_least(3, 3, 0.5) - 0.125).abs() < 1e-15);
        let of = |missed| Total { asked: 20, stated: 20, missed, ..Total::default() };
        assert!(!of(1).refuted(0.07, 0.01) && of(6).refuted(0.07, 0.01));
    }
}
