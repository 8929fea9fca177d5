//! A comparison in words: a table and a sentence for each question.

use std::fmt;

use super::{Candidate, Choice, Comparison, Outcome, Stopped, Verdicts};
use crate::number;

/// The head of the table.
const HEAD: [&str; 6] = ["scheme", "steps", "error, 95 %", "ns a step", "cost", "Casimirs"];

impl Comparison {
    /// A sentence for each question: the scheme to take and the reason, or why there is none.
    pub fn sentences(&self) -> impl Iterator<Item = String> {
        let all = [&self.for_error].into_iter().chain(&self.for_expectations);
        all.map(|verdicts| verdicts.sentence(&self.strong.sampled.reference, self.stopped))
    }
}

impl Verdicts {
    /// `an error of 1.0e-3 in y(T)`.
    fn goal(&self) -> String {
        format!("an error of {} in {}", number(self.wanted), self.quantity)
    }

    /// The scheme to take and the reason.
    fn sentence(&self, reference: &str, stopped: Option<Stopped>) -> String {
        let goal = self.goal();
        match self.choice {
            Choice::Take { scheme, cheapest } => self.taken(&goal, scheme, cheapest),
            Choice::NoneReaches => {
                let best = self.candidates.iter().filter_map(|candidate| match candidate.outcome {
                    Outcome::NotReached { steps, error, .. } => {
                        Some((&candidate.scheme, steps, error))
                    }
                    _ => None,
                });
                let best = best.min_by(|a, b| a.2.total_cmp(&b.2)).map(|(scheme, steps, error)| {
                    format!(": the least is {} by {scheme} in {steps} steps", number(error))
                });
                let budget = stopped.map_or(String::new(), |stopped| {
                    format!(" within {} s", number(stopped.budget_s))
                });
                format!("No scheme reaches {goal}{budget}{}.", best.unwrap_or_default())
            }
            Choice::WrongReference(defect) => format!(
                "No scheme is recommended: the reference, {reference}, converges to something \
                 else; its steps miss the coefficients of the equation by {}.",
                number(defect)
            ),
        }
    }

    /// Why this scheme is taken, and what the others cost.
    fn taken(&self, goal: &str, scheme: usize, cheapest: usize) -> String {
        let name = |n: usize| &self.candidates[n].scheme;
        let kept = self.candidates[scheme].keeps() == Some(true);
        let mut words = format!("Take {} for {goal}: ", name(scheme));
        if scheme == cheapest {
            words += "it is the cheapest";
            words += if kept { ", and keeps the Casimirs" } else { "" };
        } else {
            let ratio = self.ratio(scheme, cheapest).map_or(String::new(), interval);
            words += &format!("it keeps the Casimirs and costs {ratio} times {}", name(cheapest));
            words += ", the cheapest";
        }
        let others = (0..self.candidates.len()).filter(|&n| n != scheme && n != cheapest);
        let dearer = others.filter_map(|n| Some((n, self.ratio(n, scheme)?)));
        if let Some((next, ratio)) = dearer.min_by(|a, b| a.1.0.total_cmp(&b.1.0)) {
            words += &format!("; {} costs {} times as much", name(next), interval(ratio));
            words +=
                if ratio.1 <= 1.0 { ", which the errors do not tell from the same" } else { "" };
        }
        let cost = self.candidates[scheme].cost_s().unwrap_or(f64::INFINITY);
        for candidate in &self.candidates {
            if let Outcome::NotReached { steps, at_least_s, .. } = candidate.outcome {
                let times = number(at_least_s / cost);
                words += &format!("; {} does not reach it in {steps} steps", candidate.scheme);
                words += &match at_least_s >= cost {
                    true => format!(", which cost {times} times as much"),
                    false => format!(", which cost {times} times as much: it may be cheaper"),
                };
            }
        }
        words + "."
    }

    /// The cells of a row.
    fn row(&self, n: usize) -> [String; 6] {
        let Candidate { scheme, outcome, defect } = &self.candidates[n];
        let casimirs = match (defect, self.candidates[n].keeps()) {
            (Some(defect), Some(true)) => format!("kept, {}", number(*defect)),
            (Some(defect), _) => format!("off by {}", number(*defect)),
            (None, _) => String::new(),
        };
        let dash = || "–".to_owned();
        let (steps, error, ns, cost) = match outcome {
            Outcome::Reached { steps, measured, .. } => {
                let ends = [measured.lo, measured.hi].map(number).join(", ");
                let error = format!("{} [{ends}] in {}", number(measured.error), measured.steps);
                let cheapest = match self.choice {
                    Choice::Take { cheapest, .. } => self.ratio(n, cheapest),
                    _ => None,
                };
                let cost = cheapest.map_or_else(dash, |ratio| number(ratio.0));
                (format!("{:.0}", steps.ceil()), error, number(measured.step_ns), cost)
            }
            Outcome::NotReached { steps, error, .. } => {
                (format!("> {steps}"), format!("{} in {steps}", number(*error)), dash(), dash())
            }
            Outcome::Inconsistent(defect) => (
                dash(),
                format!("wrong limit: steps are off by {}", number(*defect)),
                dash(),
                dash(),
            ),
            Outcome::Fails(failure) => (dash(), format!("fails: {failure}"), dash(), dash()),
        };
        [scheme.clone(), steps, error, ns, cost, casimirs]
    }
}

/// "1.5 [1.3, 1.8]"
fn interval((value, lo, hi): (f64, f64, Option<f64>)) -> String {
    let hi = hi.map_or("…".to_owned(), number);
    format!("{} [{}, {hi}]", number(value), number(lo))
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { system, dimension, noises, t_end, strong, .. } = self;
        let sampled = &strong.sampled;
        writeln!(f, "{system}: D = {dimension}, M = {noises}, T = {t_end}")?;
        writeln!(
            f,
            "{} paths against {}, whose error is at most {}",
            sampled.samples,
            sampled.reference,
            number(strong.reference_error)
        )?;
        let failures = [Some(sampled), self.weak.as_ref().map(|weak| &weak.sampled)];
        for sampled in failures.into_iter().flatten().filter(|sampled| sampled.failed > 0) {
            let first = sampled.failures.first().map_or("", String::as_str);
            writeln!(f, "{} paths failed and are left out; the first: {first}", sampled.failed)?;
        }
        if let Some(Stopped { budget_s, steps }) = self.stopped {
            let budget = number(budget_s);
            writeln!(f, "the budget of {budget} s allowed no more than {steps} steps of a scheme")?;
        }
        for verdicts in [&self.for_error].into_iter().chain(&self.for_expectations) {
            writeln!(f, "\n{}", verdicts.goal())?;
            let rows = (0..verdicts.candidates.len()).map(|n| verdicts.row(n));
            let rows: Vec<[String; 6]> =
                [HEAD.map(str::to_owned)].into_iter().chain(rows).collect();
            let width = |c: usize| rows.iter().map(|row| row[c].chars().count()).max().unwrap_or(0);
            let widths: [usize; 6] = std::array::from_fn(width);
            for row in &rows {
                let cells = row.iter().zip(widths).map(|(cell, width)| format!("{cell:width$}"));
                writeln!(f, "  {}", cells.collect::<Vec<_>>().join("  ").trim_end())?;
            }
        }
        writeln!(f)?;
        let sentences: Vec<String> = self.sentences().collect();
        f.write_str(&sentences.join("\n"))
    }
}
