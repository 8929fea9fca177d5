//! A comparison in words: a table and sentences.

use std::fmt;

use super::{Candidate, Choice, Comparison, ErrorPoint, Keeps, Outcome, Stopped};
use crate::{aligned, number};

/// The head of the table.
const HEAD: [&str; 5] = ["scheme", "steps", "error, 95 %", "cost", "Casimirs"];

impl Comparison {
    /// Why no scheme reaches the error, and what is left to do.
    fn out_of_reach(&self) -> String {
        let Self { sampled, t_end, candidates, .. } = self;
        // The scheme that keeps most, and the fewest steps of several.
        let needs = candidates.iter().filter_map(|one| match one.outcome {
            Outcome::NotReached { needs } => Some((one, needs?)),
            _ => None,
        });
        let most = needs.max_by(|(a, x), (b, y)| a.keeps.cmp(&b.keeps).then(y.total_cmp(x)));
        if sampled.parts() && self.wanted < sampled.last_difference {
            format!(
                ": paths part, by {} for half the step, where independent ones are {} apart. \
                 Expectations may be predictable up to T = {t_end}: ask `casimir expect`.",
                number(sampled.last_difference),
                number(sampled.spread),
            )
        } else if let Some((Candidate { scheme, .. }, needs)) = most {
            let needs = number(needs);
            format!("; {scheme} would need about {needs} steps: extrapolated, not measured.")
        } else {
            "; take a longer budget or a shorter final time.".into()
        }
    }

    /// Why this scheme is taken.
    fn taken(&self, taken: &Candidate, least: &Candidate) -> String {
        let ratio = |one: &Candidate, other| one.ratio(other).map_or(String::new(), interval);
        let kept = self.lacks(&taken.keeps, &Keeps::default());
        let mut words = format!("keeps {}", if kept.is_empty() { "nothing" } else { &kept });
        words += &match taken == least {
            true => ", and is the cheapest".into(),
            false => format!(", and costs {} times {}", ratio(taken, least), least.scheme),
        };
        let reached = self.candidates.iter().filter(|one| one.cost().is_some());
        if let Some(more) = reached.max_by_key(|one| one.keeps)
            && more.keeps > taken.keeps
        {
            let (lost, scheme) = (self.lacks(&more.keeps, &taken.keeps), &more.scheme);
            words += &format!(
                ".\nGiven up: {lost}.\n  {scheme} keeps that at {} times the cost; take it for long \
                 times",
                ratio(more, taken)
            );
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
            (Outcome::Inconsistent(defect), _) => {
                format!("wrong limit: steps are off by {}", number(*defect))
            }
            (Outcome::Fails(failure), _) => format!("fails: {failure}"),
            (Outcome::NotMeasured, _) | (_, None) => "not measured".into(),
            (Outcome::NotReached { needs }, Some(point)) => {
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
        let kept = if self.keeps.casimirs { "kept" } else { "off by" };
        let casimirs = point.and_then(|point| point.defect);
        let casimirs = casimirs.map_or(String::new(), |by| format!("{kept} {}", number(by)));
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
        let taken = match self.choice {
            Choice::Take { scheme, cheapest } => {
                Some([scheme, cheapest].map(|index| &candidates[index]))
            }
            _ => None,
        };
        let rows = candidates.iter().map(|one| one.row(taken.map(|[_, cheapest]| cheapest)));
        let rows = [HEAD.map(str::to_owned)].into_iter().chain(rows).map(Vec::from);
        let table = aligned(&rows.collect::<Vec<_>>());
        table.lines().try_for_each(|line| writeln!(f, "  {line}"))?;
        write!(f, "  ≈: extrapolated; about: the reference is not exact enough")?;
        if candidates.iter().any(|one| one.asked < self.wanted) {
            write!(f, "\n  with Lévy areas: nearly exact ones, so half of the error is asked")?;
        }
        match (&self.choice, taken) {
            (_, Some([taken, least])) => {
                let because = self.taken(taken, least);
                write!(f, "\n\nTake {} for {goal}:\n  it {because}", taken.scheme)
            }
            (Choice::WrongReference(defect), _) => write!(
                f,
                "\n\nNo scheme is recommended: the reference, {reference}, converges to something \
                 else; its steps miss the coefficients of the equation by {}.",
                number(*defect)
            ),
            (Choice::NotResolved(t), _) => write!(
                f,
                "\n\nNo scheme is recommended: the finest steps do not resolve H(t) near \
                 t = {t:.4}, and all may miss the same."
            ),
            _ => write!(f, "\n\nNo scheme reaches {goal}{within}{}", self.out_of_reach()),
        }
    }
}
