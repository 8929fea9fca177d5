//! A comparison in words: a table and sentences.

use std::fmt;

use schemes::BuiltIn;

use super::{Candidate, Choice, Comparison, ErrorPoint, Keeps, Outcome, Stopped};
use crate::number;

/// The head of the table.
const HEAD: [&str; 5] = ["scheme", "steps", "error, 95 %", "cost", "Casimirs"];

impl Comparison {
    /// Why no scheme reaches the error, and what is left to do.
    fn out_of_reach(&self) -> String {
        let Self { sampled, t_end, candidates, .. } = self;
        // The scheme that keeps most, and the fewest steps of several.
        let needs = candidates.iter().filter_map(|one| match one.outcome {
            Outcome::NotReached { needs, .. } => Some((one, needs?)),
            _ => None,
        });
        let most = needs.max_by(|(a, x), (b, y)| a.keeps.cmp(&b.keeps).then(y.total_cmp(x)));
        if sampled.parts() && self.wanted < sampled.last_difference {
            format!(
                ": paths part. {} ends {} from itself with half as many steps; two independent paths \
                 end {} apart.\nSingle paths are not predictable up to T = {t_end} then, but \
                 expectations may be: ask `casimir expect`, or `compare` at a shorter final time.",
                sampled.reference,
                number(sampled.last_difference),
                number(sampled.spread),
            )
        } else if let Some((Candidate { scheme, .. }, needs)) = most {
            let needs = number(needs);
            format!(".\n{scheme} would need about {needs} steps: extrapolated, not measured.")
        } else {
            "; take a longer budget or a shorter final time.".into()
        }
    }

    /// Why this scheme is taken, and what others would cost.
    fn taken(&self, scheme: usize, cheapest: usize) -> String {
        let (taken, least) = (&self.candidates[scheme], &self.candidates[cheapest]);
        let ratio = |one: &Candidate, other| one.ratio(other).map_or(String::new(), interval);
        let mut words = match self.lacks(&taken.keeps, &Keeps::default()) {
            kept if kept.is_empty() => "keeps nothing over long times".into(),
            kept => format!("keeps {kept}"),
        };
        words += &match scheme == cheapest {
            true => ", and is the cheapest".into(),
            false => format!(", and costs {} times {}", ratio(taken, least), least.scheme),
        };
        // The cheapest of those that keep more cost significantly more.
        let more = self.candidates.iter().filter(|one| one.keeps > taken.keeps);
        let more = more.filter_map(|one| Some((one, one.ratio(taken)?.0)));
        if let Some((more, _)) = more.min_by(|a, b| a.1.total_cmp(&b.1)) {
            words += &format!(
                ".\nGiven up: {}. {} keeps that and costs {} times as much; take it for long times",
                self.lacks(&more.keeps, &taken.keeps),
                more.scheme,
                ratio(more, taken)
            );
        }
        let cost = taken.cost().map_or(f64::INFINITY, |cost| cost.0);
        let untried = self.candidates.iter().filter_map(|one| match one.outcome {
            Outcome::NotReached { at_least_s, .. } if at_least_s < cost => Some(&one.scheme[..]),
            _ => None,
        });
        let untried: Vec<&str> = untried.collect();
        if !untried.is_empty() {
            words += &format!(".\nPerhaps cheaper, with more steps: {}", untried.join(", "));
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
    fn row(&self, cheapest: Option<&Self>) -> [String; 5] {
        let point = self.point().filter(|point| point.error.is_finite());
        let about = |x: f64| format!("≈ {}", number(x));
        let [mut steps, mut cost] = [const { String::new() }; 2];
        let error = match (&self.outcome, point) {
            (Outcome::NotMeasured, _) => "not measured in this time".into(),
            (Outcome::Inconsistent(defect), _) => {
                format!("wrong limit: steps are off by {}", number(*defect))
            }
            (Outcome::Fails(failure), _) => format!("fails: {failure}"),
            (_, None) => "not measured: all paths failed".into(),
            (Outcome::NotReached { needs, .. }, Some(point)) => {
                steps = needs.map_or(format!("> {}", point.steps), about);
                let step_s = point.time.map(|time| time.best / point.steps as f64);
                let needed = needs.zip(step_s).zip(cheapest.and_then(Self::cost));
                cost = needed.map_or(String::new(), |((n, s), least)| about(n * s / least.0));
                point.words()
            }
            (Outcome::Reached { steps: needed, .. }, Some(point)) => {
                steps = format!("{:.0}", needed.ceil());
                let ratio = cheapest.and_then(|cheapest| self.ratio(cheapest));
                cost = ratio.map_or(String::new(), interval);
                point.words()
            }
        };
        let casimirs = match point.and_then(|point| point.defect) {
            Some(defect) if self.keeps.casimirs => format!("kept, {}", number(defect)),
            Some(defect) => format!("off by {}", number(defect)),
            None => String::new(),
        };
        [self.scheme.clone(), steps, error, cost, casimirs]
    }
}

impl ErrorPoint {
    fn words(&self) -> String {
        let Self { steps, error, lo, hi, .. } = *self;
        match self.resolved {
            true => format!("{} in {steps}", interval((error, lo, Some(hi)))),
            false => format!("about {} in {steps}", number(error)),
        }
    }
}

/// "1.5 [1.3, 1.8]"
fn interval((value, lo, hi): (f64, f64, Option<f64>)) -> String {
    format!("{} [{}, {}]", number(value), number(lo), hi.map_or("…".to_owned(), number))
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { system, dimension, noises, t_end, sampled, candidates, .. } = self;
        writeln!(f, "{system}: D = {dimension}, M = {noises}, T = {t_end}")?;
        let (reference, paths) = (&sampled.reference, sampled.samples);
        if paths > 0 {
            let error = match self.reference_error {
                error if error.is_finite() => format!("is at most {}", number(error)),
                _ => "does not fall yet".into(),
            };
            let steps = sampled.steps;
            writeln!(
                f,
                "{paths} paths against {reference} with {steps} steps, whose error {error}"
            )?;
        }
        if let Some(first) = sampled.failures.first() {
            writeln!(f, "{} paths failed and are left out; the first: {first}", sampled.failed)?;
        }
        let mut within = String::new();
        if let Some(Stopped { budget_s, steps }) = self.stopped {
            within = format!(" within {} s", number(budget_s));
            writeln!(f, "schemes had up to {steps} steps{within}")?;
        }
        let goal = format!("an error of {} in y(T)", number(self.wanted));
        writeln!(f, "\n{goal}")?;
        let cheapest = match self.choice {
            Choice::Take { cheapest, .. } => Some(&candidates[cheapest]),
            _ => None,
        };
        let rows = candidates.iter().map(|one| one.row(cheapest));
        let rows: Vec<_> = [HEAD.map(str::to_owned)].into_iter().chain(rows).collect();
        let width = |c: usize| rows.iter().map(|row| row[c].chars().count()).max().unwrap_or(0);
        let widths: [usize; 5] = std::array::from_fn(width);
        for row in &rows {
            let cells = row.iter().zip(widths).map(|(cell, width)| format!("{cell:width$}"));
            writeln!(f, "  {}", cells.collect::<Vec<_>>().join("  ").trim_end())?;
        }
        let for_areas =
            |one: &Candidate| BuiltIn::named(&one.scheme).is_some_and(BuiltIn::is_for_areas);
        let notes = [
            (rows.iter().any(|row| row[1].starts_with('≈')), "≈ extrapolated from the errors"),
            (
                rows.iter().any(|row| row[2].starts_with("about")),
                "about: the distance from a reference that is not exact enough",
            ),
            (candidates.iter().any(for_areas), "-levy: errors with exact Lévy areas"),
        ];
        for (_, note) in notes.iter().filter(|(applies, _)| *applies) {
            writeln!(f, "  {note}")?;
        }
        match self.choice {
            Choice::Take { scheme, cheapest } => {
                let (id, taken) = (&candidates[scheme].scheme, self.taken(scheme, cheapest));
                write!(f, "\nTake {id} for {goal}: it {taken}")
            }
            Choice::NoneReaches => {
                write!(f, "\nNo scheme reaches {goal}{within}{}", self.out_of_reach())
            }
            Choice::WrongReference(defect) => write!(
                f,
                "\nNo scheme is recommended: the reference, {reference}, converges to something \
                 else; its steps miss the coefficients of the equation by {}.",
                number(defect)
            ),
        }
    }
}
