//! A comparison in words: a table and sentences.

use std::fmt;

use super::{Candidate, Choice, Comparison, ErrorPoint, Keeps, Outcome, Stopped};
use crate::number;

/// The head of the table.
const HEAD: [&str; 6] = ["scheme", "steps", "error, 95 %", "ns a step", "cost", "Casimirs"];

impl Comparison {
    /// `an error of 1.0e-3 in y(T)`.
    fn goal(&self) -> String {
        format!("an error of {} in y(T)", number(self.wanted))
    }

    /// Sentences: the scheme to take, what it keeps and what it costs, or why there is none.
    fn sentences(&self) -> String {
        match self.choice {
            Choice::Take { scheme, cheapest } => self.taken(scheme, cheapest),
            Choice::NoneReaches => self.out_of_reach(),
            Choice::WrongReference(defect) => format!(
                "No scheme is recommended: the reference, {}, converges to something else; its \
                 steps miss the coefficients of the equation by {}.",
                self.sampled.reference,
                number(defect)
            ),
        }
    }

    /// Why no scheme reaches the error, and what is left to do.
    fn out_of_reach(&self) -> String {
        let Self { sampled, t_end, stopped, candidates, .. } = self;
        let budget = stopped.map_or(String::new(), |s| format!(" within {} s", number(s.budget_s)));
        let none = format!("No scheme reaches {}{budget}", self.goal());
        // The scheme that keeps most, and the fewest steps of several.
        let tried = candidates.iter().filter_map(|one| match one.outcome {
            Outcome::NotReached { needs, .. } => Some((one, needs)),
            _ => None,
        });
        let needs = tried.clone().filter_map(|(one, needs)| Some((one, needs?)));
        let most = needs.max_by(|(a, x), (b, y)| a.keeps.cmp(&b.keeps).then(y.total_cmp(x)));
        let measured = tried.filter_map(|(one, _)| Some((one, one.point()?)));
        let measured = measured.filter(|(_, point)| point.error.is_finite());
        let least = measured.min_by(|a, b| a.1.error.total_cmp(&b.1.error));
        if sampled.parts() && self.wanted < sampled.last_difference {
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
            let (error, steps) = (number(point.error), point.steps);
            format!("{none}. The least is {error} by {scheme} in {steps} steps.")
        } else {
            format!("{none}: nothing was measured; take a longer budget or a shorter final time.")
        }
    }

    /// Why this scheme is taken, and what the others cost.
    fn taken(&self, scheme: usize, cheapest: usize) -> String {
        let candidates = &self.candidates;
        let (taken, least) = (&candidates[scheme], &candidates[cheapest]);
        let mut words = format!("Take {} for {}: it ", taken.scheme, self.goal());
        let kept = self.lacks(&taken.keeps, &Keeps::default());
        let ratio = |one: &Candidate, other| one.ratio(other).map_or(String::new(), interval);
        words += &if scheme != cheapest {
            format!(
                "keeps {kept}, and costs {} times {}, the cheapest, which loses {}",
                ratio(taken, least),
                least.scheme,
                self.lacks(&taken.keeps, &least.keeps)
            )
        } else if kept.is_empty() {
            "is the cheapest, and keeps nothing over long times".to_owned()
        } else {
            format!("is the cheapest, and keeps {kept}")
        };
        let others = candidates.iter().enumerate().filter(|(n, one)| {
            let lo = one.ratio(least).map(|(_, lo, _)| lo);
            *n != scheme && *n != cheapest && lo.is_some_and(|lo| lo <= 1.0)
        });
        let same: Vec<&str> = others.map(|(_, one)| &one.scheme[..]).collect();
        if !same.is_empty() {
            let same = same.join(", ");
            words += &format!("; equal in cost within the errors: {}, {same}", least.scheme);
        }
        // The cheapest of those that keep more cost significantly more.
        let more = candidates.iter().filter(|one| one.keeps > taken.keeps);
        let more = more.filter_map(|one| Some((one, one.ratio(taken)?.0)));
        if let Some((more, _)) = more.min_by(|a, b| a.1.total_cmp(&b.1)) {
            words += &format!(
                ".\nGiven up: {}. {} keeps that and costs {} times as much; take it for long times",
                self.lacks(&more.keeps, &taken.keeps),
                more.scheme,
                ratio(more, taken)
            );
        }
        let cost = taken.cost_s().unwrap_or(f64::INFINITY);
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

impl Candidate {
    /// The cells of a row; costs are multiples of that of the cheapest.
    fn row(&self, cheapest: Option<&Self>) -> [String; 6] {
        let dash = || "–".to_owned();
        let (point, extrapolated) = (self.point(), |x: f64| format!("≈ {}", number(x)));
        let seconds = |point: &ErrorPoint| Some(point.time?.best / point.steps as f64);
        let step_s = point.and_then(seconds);
        let mut error = match point {
            Some(point) if point.error.is_nan() => "not measured: all paths failed".into(),
            Some(ErrorPoint { steps, error, lo, hi, .. }) => {
                let ends = [*lo, *hi].map(number).join(", ");
                format!("{} [{ends}] in {steps}", number(*error))
            }
            None => String::new(),
        };
        let (mut steps, mut cost) = (None, None);
        match &self.outcome {
            Outcome::Reached { steps: needed, .. } => {
                steps = Some(format!("{:.0}", needed.ceil()));
                cost = cheapest.and_then(|cheapest| self.ratio(cheapest)).map(interval);
            }
            Outcome::NotReached { needs, .. } => {
                let finite = point.filter(|point| point.error.is_finite());
                if let Some(point) = finite.filter(|point| !point.resolved) {
                    error = format!("about {} in {}", number(point.error), point.steps);
                }
                let beyond = |point: &ErrorPoint| format!("> {}", point.steps);
                steps = needs.map(extrapolated).or(finite.map(beyond));
                let least = cheapest.and_then(Self::cost_s);
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
            Some(defect) if self.keeps.casimirs => format!("kept, {}", number(defect)),
            Some(defect) => format!("off by {}", number(defect)),
            None => String::new(),
        };
        let nanoseconds = step_s.map(|step_s| number(1e9 * step_s));
        let [steps, ns, cost] = [steps, nanoseconds, cost].map(|cell| cell.unwrap_or_else(dash));
        [self.scheme.clone(), steps, error, ns, cost, casimirs]
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
            let error = match self.reference_error {
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
        writeln!(f, "\n{}", self.goal())?;
        let cheapest = match self.choice {
            Choice::Take { cheapest, .. } => Some(&self.candidates[cheapest]),
            _ => None,
        };
        let rows = self.candidates.iter().map(|one| one.row(cheapest));
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
        write!(f, "\n{}", self.sentences())
    }
}
