//! A comparison in words: a table and sentences.

use std::fmt;

use super::{Candidate, Choice, Comparison, ErrorPoint, Keeps, Outcome, Sampled, Stopped};
use crate::{aligned, number};

/// The head of the table.
const HEAD: [&str; 5] = ["scheme", "steps", "error, 95 %", "cost", "Casimirs"];

impl Comparison {
    /// Says why no scheme reaches the error, and what is left to do.
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

    /// Says why the scheme `taken` is recommended.
    fn taken(&self, taken: &Candidate, least: &Candidate) -> String {
        let ratio = |one: &Candidate, other| one.ratio(other).map_or(String::new(), interval);
        let kept = self.lacks(&taken.keeps, &Keeps::default());
        let mut words = format!("keeps {}", if kept.is_empty() { "nothing" } else { &kept });
        let mut others = self.candidates.iter().filter_map(Candidate::extrapolated_s);
        words += &match taken == least {
            true if others.any(|other| taken.cost().is_some_and(|(cost, ..)| other < cost)) => {
                ", and is the cheapest of those that were measured at this error".into()
            }
            true => ", and is the cheapest".into(),
            false => format!(", and costs {} times {}", ratio(taken, least), least.scheme),
        };
        let reached = self.candidates.iter().filter(|one| one.cost().is_some());
        if let Some(more) = reached.max_by_key(|one| one.keeps)
            && more.keeps > taken.keeps
        {
            words += &format!(
                ".\nGiven up: {}.\n  {} keeps that at {} times the cost; take it for long times",
                self.lacks(&more.keeps, &taken.keeps),
                more.scheme,
                ratio(more, taken)
            );
        }
        words + "."
    }

    /// Lists the properties that `one` conserves and `other` does not.
    fn lacks(&self, one: &Keeps, other: &Keeps) -> String {
        let damping = self.damped || !one.energy;
        let conformal = if self.damped { "the exact damping" } else { "bounds of the energy" };
        let all = [
            (one.casimirs && !other.casimirs, "the Casimirs"),
            (one.energy && !other.energy, "the energy of H₀"),
            (one.conformal && !other.conformal && damping, conformal),
        ];
        all.iter().filter(|(lost, _)| *lost).map(|(_, name)| *name).collect::<Vec<_>>().join(", ")
    }
}

impl Candidate {
    /// The cells of a row; costs are multiples of that of the cheapest.
    fn row(&self, cheapest: Option<&Self>) -> Vec<String> {
        let point = self.point().filter(|point| point.error.is_finite());
        let about = |x: f64| format!("≈ {}", number(x));
        let [mut steps, mut cost, mut casimirs] = [const { String::new() }; 3];
        let mut error = "not measured".into();
        if let Some(point) = point {
            error = point.words();
            let kept = if self.keeps.casimirs { "kept" } else { "off by" };
            casimirs = point.defect.map_or(casimirs, |by| format!("{kept} {}", number(by)));
        }
        match (&self.outcome, point) {
            (Outcome::Inconsistent(defect), _) => {
                error = format!("wrong limit: steps are off by {}", number(*defect));
            }
            (Outcome::Fails(failure), _) => error = format!("fails: {failure}"),
            (Outcome::NotReached { needs }, Some(point)) => {
                steps = needs.map_or(format!("> {}", point.steps), about);
                let seconds = self.extrapolated_s().zip(cheapest.and_then(Self::cost));
                cost = seconds.map_or(cost, |(needed, (least, ..))| about(needed / least));
            }
            (Outcome::Reached { steps: needed, .. }, Some(_)) => {
                steps = format!("{:.0}", needed.ceil());
                cost = cheapest.and_then(|least| self.ratio(least)).map_or(cost, interval);
            }
            _ => {}
        }
        vec![self.scheme.clone(), steps, error, cost, casimirs]
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

/// Formats a value with its interval, for example "1.5 [1.3, 1.8]".
fn interval((value, lo, hi): (f64, f64, Option<f64>)) -> String {
    format!("{} [{}, {}]", number(value), number(lo), hi.map_or("…".to_owned(), number))
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { system, dimension, noises, t_end, sampled, candidates, .. } = self;
        writeln!(f, "{system}: D = {dimension}, M = {noises}, T = {t_end}")?;
        let Sampled { samples, reference, steps, failed, failures, .. } = sampled;
        if *samples > 0 {
            write!(f, "{samples} paths against {reference} with {steps} steps, whose error ")?;
            match self.reference_error {
                error if error.is_finite() => writeln!(f, "is at most {}", number(error)),
                _ => writeln!(f, "does not fall yet"),
            }?;
        }
        if let Some(first) = failures.first() {
            writeln!(f, "{failed} paths failed and are left out; the first: {first}")?;
        }
        let mut within = String::new();
        if let Some(Stopped { budget_s, steps }) = self.stopped {
            within = format!(" within {} s", number(budget_s));
            writeln!(f, "schemes had up to {steps} steps{within}")?;
        }
        let goal = format!("an error of {} in y(T)", number(self.wanted));
        let taken = match self.choice {
            Choice::Take { scheme, cheapest } => Some((&candidates[scheme], &candidates[cheapest])),
            _ => None,
        };
        let rows = candidates.iter().map(|one| one.row(taken.map(|(_, cheapest)| cheapest)));
        let rows: Vec<_> = [HEAD.map(String::from).into()].into_iter().chain(rows).collect();
        writeln!(f, "\n{goal}\n  {}", aligned(&rows).trim_end().replace('\n', "\n  "))?;
        writeln!(f, "  ≈: extrapolated; about: limited by the error of the reference")?;
        if candidates.iter().any(|one| one.asked < self.wanted) {
            let words = "Lévy areas are better than those of a run: half of the error is asked";
            writeln!(f, "  {words}")?;
        }
        writeln!(f)?;
        match (&self.choice, taken) {
            (_, Some((taken, least))) => {
                write!(f, "Take {} for {goal}:\n  it {}", taken.scheme, self.taken(taken, least))
            }
            (Choice::WrongReference(defect), _) => write!(
                f,
                "No scheme is recommended: the reference, {reference}, converges to something \
                 else; its steps miss the coefficients of the equation by {}.",
                number(*defect)
            ),
            (Choice::NotResolved(t), _) => write!(
                f,
                "No scheme is recommended: the finest steps do not resolve a function of t near t = \
                 {t:.4}, and all may miss the same."
            ),
            _ => write!(f, "No scheme reaches {goal}{within}{}", self.out_of_reach()),
        }
    }
}
