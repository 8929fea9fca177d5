//! A comparison in words: a table and sentences for each question.

use std::fmt;

use super::{Candidate, Choice, Comparison, Keeps, Outcome, Stopped, Verdicts};
use crate::number;

/// The head of the table.
const HEAD: [&str; 6] = ["scheme", "steps", "error, 95 %", "ns a step", "cost", "Casimirs"];

impl Comparison {
    /// Sentences for each question: the scheme to take, what it keeps and what it costs, or why
    /// there is none.
    pub fn sentences(&self) -> impl Iterator<Item = String> {
        let all = [&self.for_error].into_iter().chain(&self.for_expectations);
        all.map(|verdicts| match verdicts.choice {
            Choice::Take { scheme, cheapest } => self.taken(verdicts, scheme, cheapest),
            Choice::NoneReaches => self.out_of_reach(verdicts),
            Choice::WrongReference(defect) => format!(
                "No scheme is recommended: the reference, {}, converges to something else; its \
                 steps miss the coefficients of the equation by {}.",
                self.strong.sampled.reference,
                number(defect)
            ),
        })
    }

    /// Why no scheme reaches the error, and what is left to do.
    fn out_of_reach(&self, verdicts: &Verdicts) -> String {
        let Verdicts { candidates, wanted, quantity, .. } = verdicts;
        let strong = &self.strong;
        let budget = self
            .stopped
            .map_or(String::new(), |stopped| format!(" within {} s", number(stopped.budget_s)));
        let mut words = format!("No scheme reaches {}{budget}", verdicts.goal());
        let measured = |n: &Candidate| match n.outcome {
            Outcome::NotReached { steps, error, needs, .. } if error.is_finite() => {
                Some((steps, error, needs))
            }
            _ => None,
        };
        let all = || candidates.iter().filter_map(|n| Some((&n.scheme, measured(n)?)));
        // The scheme that keeps most, and the fewest steps of several.
        let needs = candidates.iter().filter_map(|n| Some((n, measured(n)?.2?)));
        let most = needs.max_by(|(a, x), (b, y)| a.keeps.cmp(&b.keeps).then(y.total_cmp(x)));
        if quantity == "y(T)" && strong.parts() && *wanted < strong.last_difference {
            words += &format!(
                ": paths part. {} ends {} from itself with half as many steps; two independent \
                 paths end {} apart. How many steps would do cannot be told.\nSingle paths are not \
                 predictable up to T = {} then, but expectations may be: ask `casimir run` or \
                 `casimir expect` for these, or `compare` at a shorter final time",
                strong.sampled.reference,
                number(strong.last_difference),
                number(strong.spread),
                self.t_end
            );
        } else if let Some((Candidate { scheme, keeps, .. }, needs)) = most {
            let kept = self.lacks(keeps, &Keeps::default());
            words += &format!(
                ".\n{scheme} would need about {} steps, which is extrapolated, not \
                 measured{}{kept}",
                number(needs),
                if kept.is_empty() { "" } else { "; it keeps " }
            );
        } else if let Some((scheme, (steps, error, _))) =
            all().min_by(|a, b| a.1.1.total_cmp(&b.1.1))
        {
            let error = number(error);
            words += &format!(". The least is {error} by {scheme} in {steps} steps");
        } else {
            words += ": nothing was measured; take a longer budget or a shorter final time";
        }
        words + "."
    }

    /// Why this scheme is taken, and what the others cost.
    fn taken(&self, verdicts: &Verdicts, scheme: usize, cheapest: usize) -> String {
        let candidates = &verdicts.candidates;
        let Candidate { scheme: name, keeps, .. } = &candidates[scheme];
        let mut words = format!("Take {name} for {}: ", verdicts.goal());
        let kept = self.lacks(keeps, &Keeps::default());
        words += &match (scheme == cheapest, kept.is_empty()) {
            (true, true) => "it is the cheapest, and keeps nothing over long times".to_owned(),
            (true, false) => format!("it is the cheapest, and keeps {kept}"),
            (false, _) => {
                let Candidate { scheme: other, keeps: less, .. } = &candidates[cheapest];
                let ratio = verdicts.ratio(scheme, cheapest).map_or(String::new(), interval);
                let lost = self.lacks(keeps, less);
                format!(
                    "it keeps {kept}, and costs {ratio} times {other}, the cheapest, which loses \
                     {lost}"
                )
            }
        };
        let reached = (0..candidates.len()).filter(|&n| candidates[n].cost_s().is_some());
        // The cheapest of those that keep more cost significantly more.
        let more = reached.clone().filter(|&n| candidates[n].keeps > *keeps);
        let dearer = reached.filter(|&n| n != scheme && n != cheapest);
        let least = |all: &mut dyn Iterator<Item = usize>| {
            let costs = all.filter_map(|n| Some((n, verdicts.ratio(n, scheme)?)));
            costs.min_by(|a, b| a.1.0.total_cmp(&b.1.0))
        };
        if let Some((n, ratio)) = least(&mut dearer.into_iter()) {
            let (other, ratio, lo) = (&candidates[n].scheme, interval(ratio), ratio.1);
            words += &format!("; {other} costs {ratio} times as much");
            words += if lo <= 1.0 { ", which the errors do not tell from the same" } else { "" };
        }
        if let Some((n, ratio)) = least(&mut more.into_iter()) {
            let Candidate { scheme: other, keeps: more, .. } = &candidates[n];
            let (lost, ratio) = (self.lacks(more, keeps), interval(ratio));
            words += &format!(
                ".\nGiven up: {lost}. {other} keeps that and costs {ratio} times as much; take it \
                 for long times"
            );
        }
        let cost = candidates[scheme].cost_s().unwrap_or(f64::INFINITY);
        for Candidate { scheme, outcome, .. } in candidates {
            if let Outcome::NotReached { steps, at_least_s, .. } = outcome
                && *at_least_s < cost
            {
                words +=
                    &format!(".\n{scheme} may be cheaper: it was not tried beyond {steps} steps");
            }
        }
        words + "."
    }

    /// What one keeps and another does not.
    fn lacks(&self, one: &Keeps, other: &Keeps) -> String {
        let conformal = if self.damped { "the exact damping" } else { "bounds of the energy" };
        let all = [
            (one.casimirs && !other.casimirs, "the Casimirs"),
            (one.energy && !other.energy, "the energy of H₀"),
            (one.conformal && !other.conformal && (self.damped || !one.energy), conformal),
        ];
        let lost: Vec<&str> = all.iter().filter(|(lost, _)| *lost).map(|(_, name)| *name).collect();
        lost.join(", ")
    }
}

impl Verdicts {
    /// `an error of 1.0e-3 in y(T)`.
    fn goal(&self) -> String {
        format!("an error of {} in {}", number(self.wanted), self.quantity)
    }

    /// The cells of a row.
    fn row(&self, n: usize) -> [String; 6] {
        let Candidate { scheme, outcome, defect, .. } = &self.candidates[n];
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
            Outcome::NotReached { error, .. } if error.is_nan() => {
                (dash(), "not measured: all paths failed".into(), dash(), dash())
            }
            Outcome::NotReached { steps, error, at_least_s, resolved, needs } => {
                let about = if *resolved { "" } else { "about " };
                let step_s = at_least_s / *steps as f64;
                let cheapest = match self.choice {
                    Choice::Take { cheapest, .. } => self.candidates[cheapest].cost_s(),
                    _ => None,
                };
                let extrapolated = |x: f64| format!("≈ {}", number(x));
                let cost = needs.zip(cheapest).map(|(n, cost)| extrapolated(n * step_s / cost));
                (
                    needs.map_or(format!("> {steps}"), extrapolated),
                    format!("{about}{} in {steps}", number(*error)),
                    number(1e9 * step_s),
                    cost.unwrap_or_else(dash),
                )
            }
            Outcome::NotMeasured => (dash(), "not measured in this time".into(), dash(), dash()),
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
        let reference = &sampled.reference;
        if sampled.failed > 0 && sampled.failed >= sampled.samples {
            writeln!(f, "all {} paths failed, so that no error was measured", sampled.failed)?;
        } else if strong.reference_error.is_finite() {
            let error = number(strong.reference_error);
            let paths = sampled.samples;
            writeln!(f, "{paths} paths against {reference}, whose error is at most {error}")?;
        } else if sampled.samples > 0 {
            let paths = sampled.samples;
            writeln!(f, "{paths} paths against {reference}, whose error does not fall yet")?;
        }
        let failures = [Some(sampled), self.weak.as_ref().map(|weak| &weak.sampled)];
        for sampled in failures.into_iter().flatten().filter(|sampled| sampled.failed > 0) {
            let first = sampled.failures.first().map_or("", String::as_str);
            writeln!(f, "{} paths failed and are left out; the first: {first}", sampled.failed)?;
        }
        if let Some(Stopped { budget_s, steps }) = self.stopped {
            let budget = number(budget_s);
            writeln!(
                f,
                "schemes had up to {steps} steps; more would exceed the budget of {budget} s"
            )?;
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
            if rows.iter().any(|row| row[1].starts_with('≈')) {
                writeln!(f, "  ≈ extrapolated from the measured errors")?;
            }
            if rows.iter().any(|row| row[2].starts_with("about")) {
                writeln!(f, "  about: the distance from a reference that is not exact enough")?;
            }
        }
        writeln!(f)?;
        let sentences: Vec<String> = self.sentences().collect();
        f.write_str(&sentences.join("\n"))
    }
}
