//! A comparison in words: a table and sentences for each question.

use std::fmt;

use super::{Answer, Candidate, Choice, Comparison, ErrorPoint, Keeps, Outcome, Stopped};
use crate::number;

/// The head of the table.
const HEAD: [&str; 6] = ["scheme", "steps", "error, 95 %", "ns a step", "cost", "Casimirs"];

impl Comparison {
    /// The answers, that for the strong error first.
    pub fn answers(&self) -> impl Iterator<Item = &Answer> {
        [&self.for_error].into_iter().chain(&self.for_expectations)
    }

    /// Sentences for a question: the scheme to take, what it keeps and what it costs, or why there
    /// is none.
    fn sentences(&self, answer: &Answer) -> String {
        match answer.choice {
            Choice::Take { scheme, cheapest } => self.taken(answer, scheme, cheapest),
            Choice::NoneReaches => self.out_of_reach(answer),
            Choice::WrongReference(defect) => format!(
                "No scheme is recommended: the reference, {}, converges to something else; its \
                 steps miss the coefficients of the equation by {}.",
                self.sampled.reference,
                number(defect)
            ),
        }
    }

    /// Why no scheme reaches the error, and what is left to do.
    fn out_of_reach(&self, answer: &Answer) -> String {
        let Self { sampled, t_end, stopped, .. } = self;
        let budget = stopped.map_or(String::new(), |s| format!(" within {} s", number(s.budget_s)));
        let none = format!("No scheme reaches {}{budget}", answer.goal());
        // The scheme that keeps most, and the fewest steps of several.
        let needs = answer.candidates.iter().filter_map(|n| match n.outcome {
            Outcome::NotReached { needs, .. } => Some((n, needs?)),
            _ => None,
        });
        let most = needs.max_by(|(a, x), (b, y)| a.keeps.cmp(&b.keeps).then(y.total_cmp(x)));
        let measured = answer.candidates.iter().filter_map(|n| match n.outcome {
            Outcome::NotReached { .. } => Some((n, n.point()?)),
            _ => None,
        });
        let measured = measured.filter(|(_, point)| point.error.is_finite());
        let least = measured.min_by(|a, b| a.1.error.abs().total_cmp(&b.1.error.abs()));
        if answer.mean.is_none() && sampled.parts() && answer.wanted < sampled.last_difference {
            format!(
                "{none}: paths part. {} ends {} from itself with half as many steps; two \
                 independent paths end {} apart. How many steps would do cannot be told.\nSingle \
                 paths are not predictable up to T = {t_end} then, but expectations may be: ask \
                 `casimir run` or `casimir expect` for these, or `compare` at a shorter final time.",
                sampled.reference,
                number(sampled.last_difference),
                number(sampled.spread),
            )
        } else if let Some((Candidate { scheme, .. }, needs)) = most {
            format!(
                "{none}.\n{scheme} would need about {} steps, which is extrapolated, not measured.",
                number(needs)
            )
        } else if let Some((Candidate { scheme, .. }, point)) = least {
            let (error, steps) = (number(point.error.abs()), point.steps);
            format!("{none}. The least is {error} by {scheme} in {steps} steps.")
        } else {
            format!("{none}: nothing was measured; take a longer budget or a shorter final time.")
        }
    }

    /// Why this scheme is taken, and what the others cost.
    fn taken(&self, answer: &Answer, scheme: usize, cheapest: usize) -> String {
        let candidates = &answer.candidates;
        let Candidate { scheme: name, keeps, .. } = &candidates[scheme];
        let mut words = format!("Take {name} for {}: it ", answer.goal());
        let kept = self.lacks(keeps, &Keeps::default());
        let ratio = |n, of| answer.ratio(n, of).map_or(String::new(), interval);
        words += &if scheme != cheapest {
            let Candidate { scheme: other, keeps: less, .. } = &candidates[cheapest];
            format!(
                "keeps {kept}, and costs {} times {other}, the cheapest, which loses {}",
                ratio(scheme, cheapest),
                self.lacks(keeps, less)
            )
        } else if kept.is_empty() {
            "is the cheapest, and keeps nothing over long times".to_owned()
        } else {
            format!("is the cheapest, and keeps {kept}")
        };
        let others = (0..candidates.len()).filter(|&n| n != scheme && n != cheapest);
        let ratios = others.filter_map(|n| Some((n, answer.ratio(n, cheapest)?)));
        let same = ratios.filter(|(_, (_, lo, _))| *lo <= 1.0);
        let same: Vec<&str> = same.map(|(n, _)| &candidates[n].scheme[..]).collect();
        if !same.is_empty() {
            let cheapest = &candidates[cheapest].scheme;
            words += &format!("; equal in cost within the errors: {cheapest}, {}", same.join(", "));
        }
        // The cheapest of those that keep more cost significantly more.
        let more = (0..candidates.len()).filter(|&n| candidates[n].keeps > *keeps);
        let more = more.filter_map(|n| Some((n, answer.ratio(n, scheme)?.0)));
        if let Some((n, _)) = more.min_by(|a, b| a.1.total_cmp(&b.1)) {
            let Candidate { scheme: other, keeps: more, .. } = &candidates[n];
            words += &format!(
                ".\nGiven up: {}. {other} keeps that and costs {} times as much; take it for long \
                 times",
                self.lacks(more, keeps),
                ratio(n, scheme)
            );
        }
        let cost = candidates[scheme].cost_s().unwrap_or(f64::INFINITY);
        for Candidate { scheme, outcome, points, .. } in candidates {
            if let (Outcome::NotReached { at_least_s, .. }, Some(last)) = (outcome, points.last())
                && *at_least_s < cost
            {
                let steps = last.steps;
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

impl Answer {
    /// `an error of 1.0e-3 in y(T)`.
    fn goal(&self) -> String {
        format!("an error of {} in {}", number(self.wanted), self.quantity)
    }

    /// The cells of a row.
    fn row(&self, n: usize) -> [String; 6] {
        let candidate = &self.candidates[n];
        let dash = || "–".to_owned();
        let (point, extrapolated) = (candidate.point(), |x: f64| format!("≈ {}", number(x)));
        let cheapest = match self.choice {
            Choice::Take { cheapest, .. } => Some(cheapest),
            _ => None,
        };
        let seconds = |point: &ErrorPoint| Some(point.time?.best / point.steps as f64);
        let step_s = point.and_then(seconds);
        let mut error = match point {
            Some(point) if point.error.is_nan() => "not measured: all paths failed".into(),
            Some(ErrorPoint { steps, error, lo, hi, .. }) => {
                let ends = [*lo, *hi].map(number).join(", ");
                format!("{} [{ends}] in {steps}", number(error.abs()))
            }
            None => String::new(),
        };
        let (mut steps, mut cost) = (None, None);
        match &candidate.outcome {
            Outcome::Reached { steps: needed, .. } => {
                steps = Some(format!("{:.0}", needed.ceil()));
                cost = cheapest.and_then(|cheapest| self.ratio(n, cheapest)).map(interval);
            }
            Outcome::NotReached { needs, .. } => {
                let finite = point.filter(|point| point.error.is_finite());
                if let Some(point) = finite.filter(|point| !point.resolved) {
                    error = format!("about {} in {}", number(point.error), point.steps);
                }
                let beyond = |point: &ErrorPoint| format!("> {}", point.steps);
                steps = needs.map(extrapolated).or(finite.map(beyond));
                let least = cheapest.and_then(|cheapest| self.candidates[cheapest].cost_s());
                let needed = needs.zip(step_s).zip(least);
                cost = needed.map(|((needs, step_s), least)| extrapolated(needs * step_s / least));
            }
            Outcome::NotMeasured => error = "not measured in this time".into(),
            Outcome::Inconsistent(defect) => {
                error = format!("wrong limit: steps are off by {}", number(*defect));
            }
            Outcome::Fails(failure) => error = format!("fails: {failure}"),
        }
        let casimirs = match point.and_then(|point| point.defect) {
            Some(defect) if candidate.keeps.casimirs => format!("kept, {}", number(defect)),
            Some(defect) => format!("off by {}", number(defect)),
            None => String::new(),
        };
        let nanoseconds = step_s.map(|step_s| number(1e9 * step_s));
        let [steps, ns, cost] = [steps, nanoseconds, cost].map(|cell| cell.unwrap_or_else(dash));
        [candidate.scheme.clone(), steps, error, ns, cost, casimirs]
    }
}

/// "1.5 [1.3, 1.8]"
fn interval((value, lo, hi): (f64, f64, Option<f64>)) -> String {
    format!("{} [{}, {}]", number(value), number(lo), hi.map_or("…".to_owned(), number))
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { system, dimension, noises, t_end, sampled, .. } = self;
        writeln!(f, "{system}: D = {dimension}, M = {noises}, T = {t_end}")?;
        let (paths, failed) = (sampled.samples, sampled.failed);
        if failed > 0 && failed >= paths {
            writeln!(f, "all {failed} paths failed, so that no error was measured")?;
        } else if paths > 0 {
            let error = match self.for_error.reference_error {
                error if error.is_finite() => format!("is at most {}", number(error)),
                _ => "does not fall yet".into(),
            };
            let (reference, steps) = (&sampled.reference, sampled.steps);
            writeln!(
                f,
                "{paths} paths against {reference} with {steps} steps, whose error {error}"
            )?;
        }
        if failed > 0 {
            let first = sampled.failures.first().map_or("", String::as_str);
            writeln!(f, "{failed} paths failed and are left out; the first: {first}")?;
        }
        if let Some(Stopped { budget_s, steps }) = self.stopped {
            let budget = number(budget_s);
            writeln!(
                f,
                "schemes had up to {steps} steps; more would exceed the budget of {budget} s"
            )?;
        }
        for answer in self.answers() {
            writeln!(f, "\n{}", answer.goal())?;
            let rows = (0..answer.candidates.len()).map(|n| answer.row(n));
            let rows: Vec<_> = [HEAD.map(str::to_owned)].into_iter().chain(rows).collect();
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
        let sentences: Vec<String> = self.answers().map(|answer| self.sentences(answer)).collect();
        write!(f, "\n{}", sentences.join("\n"))
    }
}
