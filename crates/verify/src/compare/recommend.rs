//! Which scheme to take, from errors and times.

use serde::{Deserialize, Serialize};

use super::{
    cost::cost_at,
    grid::Series,
    strong::StrongPoint,
    weak::{Cost, WeakPoint},
};

/// How a scheme fares at the wanted error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Candidate {
    /// Its identifier.
    pub scheme: String,
    /// Whether it reaches the error, and at which price.
    pub outcome: Outcome,
    /// The largest relative defect of a Casimir at the step size that is needed; none if no Casimir
    /// is known.
    pub defect: Option<f64>,
}

/// Whether a scheme reaches the wanted error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// It does.
    Reached {
        /// Steps of a path for the wanted error, between those measured; at most these, if the
        /// coarsest do.
        steps: f64,
        /// Seconds of processor time: of a path for a strong error, of an estimate for an
        /// expectation.
        cost_s: f64,
        /// Ends of its interval, from those of errors and times; no upper one where the errors do
        /// not reach far enough.
        cost_lo: f64,
        /// Upper end.
        cost_hi: Option<f64>,
        /// The measured point beside it.
        measured: Measured,
    },
    /// It does not with the steps that were measured.
    NotReached {
        /// The most steps.
        steps: u64,
        /// The error, or the upper end of the bias, with these.
        error: f64,
        /// Seconds that the wanted error costs at least, as far as they were timed.
        at_least_s: f64,
    },
    /// Single steps miss the coefficients of the equation as τ → 0 by this part: the scheme
    /// converges to something else.
    Inconsistent(f64),
    /// Paths fail at all step sizes; the first failure.
    Fails(String),
}

/// A measured error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Steps of a path.
    pub steps: u64,
    /// The strong error, or the size of the bias.
    pub error: f64,
    /// Lower end of its interval.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
    /// Nanoseconds of a step.
    pub step_ns: f64,
}

/// A scheme to take, or why there is none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Choice {
    /// This one of the candidates.
    Take {
        /// Its number.
        scheme: usize,
        /// Number of the cheapest one. Another one is taken if it keeps the Casimirs and costs
        /// hardly more.
        cheapest: usize,
    },
    /// No scheme reaches the error.
    NoneReaches,
    /// Single steps of the reference miss the coefficients of the equation by this part: its errors
    /// are not the errors.
    WrongReference(f64),
}

/// A Casimir with a smaller relative defect is kept: rounding is all that is left.
const KEPT: f64 = 1e-10;
/// A scheme that keeps Casimirs may cost this factor more.
const WORTH: f64 = 1.1;

impl Candidate {
    /// Whether the laws of all known Casimirs are kept to rounding.
    pub fn keeps(&self) -> Option<bool> {
        self.defect.map(|defect| defect <= KEPT)
    }

    /// Seconds, if the error is reached.
    pub fn cost_s(&self) -> Option<f64> {
        match self.outcome {
            Outcome::Reached { cost_s, .. } => Some(cost_s),
            _ => None,
        }
    }

    /// A strong error of a scheme; the defects with these numbers are those of Casimirs.
    pub(super) fn strong(series: &Series<StrongPoint>, wanted: f64, casimirs: &[usize]) -> Self {
        let ends = |point: &StrongPoint| {
            (point.lo.unwrap_or(point.error), point.hi.unwrap_or(point.error))
        };
        let costs = |pair: &dyn Fn(&StrongPoint) -> Option<(f64, f64)>| {
            least_cost(&series.curve_of(pair).points, wanted)
        };
        let cost = costs(&|point| Some((point.error, point.time?.min_s)));
        let steps = costs(&|point| point.time.map(|_| (point.error, point.steps as f64)));
        let resolved = || series.points.iter().filter(|point| point.resolved);
        let timed = || resolved().filter_map(|point| Some((point, point.time?)));
        let (outcome, point) = match cost.zip(steps) {
            Some((cost_s, steps)) => {
                let beside = timed().find(|(point, _)| point.steps as f64 >= steps);
                let measured = beside.map(|(point, time)| {
                    let (lo, hi) = ends(point);
                    let step_ns = 1e9 * time.min_s / point.steps as f64;
                    Measured { steps: point.steps, error: point.error, lo, hi, step_ns }
                });
                let nothing = Measured { steps: 0, error: 0.0, lo: 0.0, hi: 0.0, step_ns: 0.0 };
                let outcome = Outcome::Reached {
                    steps,
                    cost_s,
                    cost_lo: costs(&|point| Some((ends(point).0, point.time?.min_s)))
                        .map_or(0.0, |least| least.min(cost_s)),
                    cost_hi: costs(&|point| Some((ends(point).1, point.time?.median_s))),
                    measured: measured.unwrap_or(nothing),
                };
                (outcome, beside.map(|(point, _)| point))
            }
            None => {
                let last = resolved().next_back();
                let outcome = Outcome::NotReached {
                    steps: last.map_or(0, |point| point.steps),
                    error: last.map_or(f64::INFINITY, |point| point.error),
                    at_least_s: timed().next_back().map_or(0.0, |(_, time)| time.min_s),
                };
                (outcome, last)
            }
        };
        let defect = point
            .and_then(|point| casimirs.iter().map(|&law| point.defects[law]).reduce(crate::worse));
        Self { scheme: series.scheme.clone(), outcome, defect }
    }

    /// An expectation by a scheme.
    pub(super) fn weak(series: &Series<WeakPoint>, wanted: f64, defect: Option<f64>) -> Self {
        let point = |cost: Cost| series.points.iter().find(|point| point.steps == cost.steps);
        let cost = series.cost(wanted);
        let outcome = match cost.and_then(|cost| Some((cost, point(cost)?, point(cost)?.time?))) {
            Some((cost, point, time)) => Outcome::Reached {
                steps: cost.steps as f64,
                cost_s: cost.cost_s,
                cost_lo: series.least_cost(wanted).map_or(0.0, |least| least.cost_s),
                cost_hi: Some(cost.paths * time.median_s),
                measured: Measured {
                    steps: point.steps,
                    error: point.bias.abs(),
                    lo: point.lo,
                    hi: point.hi,
                    step_ns: 1e9 * time.min_s / point.steps as f64,
                },
            },
            None => Outcome::NotReached {
                steps: series.points.last().map_or(0, |point| point.steps),
                error: series.points.last().map_or(f64::INFINITY, |point| point.hi),
                at_least_s: series.least_cost(wanted).map_or(0.0, |least| least.cost_s),
            },
        };
        Self { scheme: series.scheme.clone(), outcome, defect }
    }
}

/// The cost of an error at most `wanted` on a curve: of the coarsest step, if that does.
fn least_cost(curve: &[(f64, f64)], wanted: f64) -> Option<f64> {
    let (_, coarsest) = curve.first()?;
    let all = curve.iter().all(|(error, _)| *error <= wanted);
    if all { Some(*coarsest) } else { cost_at(curve, wanted) }
}

/// The cheapest candidate, or one that keeps the Casimirs and costs at most a tenth more.
pub(super) fn choose(candidates: &[Candidate]) -> Choice {
    let costs = candidates.iter().enumerate().filter_map(|(n, one)| Some((n, one.cost_s()?)));
    let least = |candidates: &mut dyn Iterator<Item = (usize, f64)>| {
        candidates.min_by(|a, b| a.1.total_cmp(&b.1))
    };
    let Some((cheapest, cost)) = least(&mut costs.clone()) else { return Choice::NoneReaches };
    let keeping =
        costs.filter(|&(n, other)| candidates[n].keeps() == Some(true) && other <= WORTH * cost);
    let scheme = least(&mut keeping.into_iter()).map_or(cheapest, |(n, _)| n);
    Choice::Take { scheme, cheapest }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidate(cost_s: f64, defect: Option<f64>) -> Candidate {
        let measured = Measured { steps: 8, error: 1e-3, lo: 9e-4, hi: 1.1e-3, step_ns: 1.0 };
        let (cost_lo, cost_hi) = (0.9 * cost_s, Some(1.1 * cost_s));
        let outcome = Outcome::Reached { steps: 8.0, cost_s, cost_lo, cost_hi, measured };
        Candidate { scheme: "a".to_owned(), outcome, defect }
    }

    #[test]
    fn a_scheme_that_keeps_casimirs_may_cost_a_tenth_more() {
        let (kept, lost) = (Some(1e-14), Some(1e-3));
        let chosen = |candidates: &[Candidate]| choose(candidates);
        let take = |scheme, cheapest| Choice::Take { scheme, cheapest };
        let near = [candidate(1.0, lost), candidate(1.2, kept), candidate(1.09, kept)];
        assert_eq!(chosen(&near), take(2, 0));
        assert_eq!(chosen(&near[..2]), take(0, 0));
        assert_eq!(chosen(&[candidate(1.0, None), candidate(1.05, None)]), take(0, 0));
        let outcome = Outcome::Inconsistent(0.5);
        let wrong = Candidate { scheme: "b".to_owned(), outcome, defect: kept };
        assert_eq!(chosen(&[wrong.clone(), candidate(2.0, lost)]), take(1, 1));
        assert_eq!(chosen(&[wrong]), Choice::NoneReaches);
    }

    #[test]
    fn a_coarsest_step_that_does_is_enough() {
        assert_eq!(least_cost(&[(0.1, 1.0), (0.05, 2.0)], 0.2), Some(1.0));
        assert_eq!(least_cost(&[(0.1, 1.0), (0.05, 2.0)], 0.05), Some(2.0));
        assert_eq!(least_cost(&[(0.1, 1.0), (0.05, 2.0)], 0.01), None);
        assert_eq!(least_cost(&[], 0.01), None);
    }
}
