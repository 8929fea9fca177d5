//! Which scheme to take, from errors and times.

use schemes::{BuiltIn, Energy, Explicitness, Properties};
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
    /// What it keeps over long times.
    #[serde(default)]
    pub keeps: Keeps,
}

/// What a scheme keeps over long times; a scheme that keeps more is larger.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Keeps {
    /// The laws of all known Casimirs to rounding, as measured.
    pub casimirs: bool,
    /// The energy of H₀ without noise and damping.
    pub energy: bool,
    /// The damping is exact; without damping, the scheme is no explicit one, whose energies grow
    /// exponentially.
    pub conformal: bool,
}

impl Keeps {
    /// By the identifier of the scheme and the measured Casimirs.
    pub(super) fn of(candidate: &Candidate, damped: bool) -> Self {
        let casimirs = candidate.keeps() == Some(true);
        let Some(scheme) = BuiltIn::named(&candidate.scheme) else {
            return Self { casimirs, ..Self::default() };
        };
        let Properties { explicit, exact_damping, energy, .. } = scheme.properties();
        let conformal = match explicit {
            Explicitness::Always => false,
            Explicitness::WhereConstant => damped || casimirs,
            Explicitness::No => exact_damping || !damped,
        };
        Self { casimirs, energy: energy == Energy::Kept, conformal }
    }
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
        /// Seconds of the processor for that: what the wanted error costs at least.
        at_least_s: f64,
        /// Whether the reference resolves the error; otherwise it is a distance of paths that are
        /// both wrong.
        resolved: bool,
        /// Steps that the wanted error needs, extrapolated from the last two errors; none where
        /// these do not fall.
        needs: Option<f64>,
    },
    /// The budget was too short for a first error.
    NotMeasured,
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
        /// Number of the cheapest one. Another one is taken if it keeps more and does not cost
        /// significantly more.
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
/// A scheme that keeps more is taken unless it costs more than this factor, with 95 %.
const WORTH: f64 = 1.1;
/// Errors that fall with less than this exponent of the step size are not extrapolated.
const FALLS: f64 = 0.3;

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
                // Without a resolved point, the distance from a reference that is wrong as well.
                let last = resolved().next_back().or(series.points.last());
                let outcome = match last {
                    Some(last) => Outcome::NotReached {
                        steps: last.steps,
                        error: last.error,
                        at_least_s: last.time.map_or(0.0, |time| time.min_s),
                        resolved: last.resolved,
                        needs: match resolved().collect::<Vec<_>>()[..] {
                            [.., before, last] => {
                                let p = (before.error / last.error).log2();
                                let factor = (last.error / wanted).powf(1.0 / p.clamp(0.5, 1.0));
                                (p >= FALLS).then_some(last.steps as f64 * factor.max(1.0))
                            }
                            _ => None,
                        },
                    },
                    None => Outcome::NotMeasured,
                };
                (outcome, last)
            }
        };
        let defect = point
            .and_then(|point| casimirs.iter().map(|&law| point.defects[law]).reduce(crate::worse));
        let keeps = Keeps::default();
        Self { scheme: series.scheme.clone(), outcome, defect, keeps }
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
                resolved: true,
                needs: None,
            },
        };
        let keeps = Keeps::default();
        Self { scheme: series.scheme.clone(), outcome, defect, keeps }
    }
}

/// The cost of an error at most `wanted` on a curve: of the coarsest step, if that does.
fn least_cost(curve: &[(f64, f64)], wanted: f64) -> Option<f64> {
    let (_, coarsest) = curve.first()?;
    let all = curve.iter().all(|(error, _)| *error <= wanted);
    if all { Some(*coarsest) } else { cost_at(curve, wanted) }
}

/// How many times the cost of candidate `other` that of candidate `one` is, with its interval; no
/// upper end where there is none. `None` unless both reach the error.
pub(super) fn ratio(
    candidates: &[Candidate],
    one: usize,
    other: usize,
) -> Option<(f64, f64, Option<f64>)> {
    let ends = |n: usize| match candidates.get(n)?.outcome {
        Outcome::Reached { cost_s, cost_lo, cost_hi, .. } => Some((cost_s, cost_lo, cost_hi)),
        _ => None,
    };
    let ((a, a_lo, a_hi), (b, b_lo, b_hi)) = (ends(one)?, ends(other)?);
    let lo = b_hi.map_or(0.0, |hi| a_lo / hi);
    let hi = a_hi.filter(|_| b_lo > 0.0).map(|hi| hi / b_lo);
    Some((a / b, lo, hi))
}

/// The candidate that keeps most among those that do not cost significantly more than the cheapest.
pub(super) fn choose(candidates: &[Candidate]) -> Choice {
    let costs = candidates.iter().enumerate().filter_map(|(n, one)| Some((n, one.cost_s()?)));
    let mut costs: Vec<(usize, f64)> = costs.collect();
    costs.sort_by(|a, b| a.1.total_cmp(&b.1));
    let Some(&(cheapest, _)) = costs.first() else { return Choice::NoneReaches };
    // Without an interval the value decides.
    let near = |n: usize| match ratio(candidates, n, cheapest) {
        Some((ratio, lo, _)) => WORTH >= if lo > 0.0 { lo } else { ratio },
        None => false,
    };
    let near = costs.iter().map(|&(n, _)| n).filter(|&n| n == cheapest || near(n));
    // Of several the last is taken, so the cheapest come last.
    let most = near.rev().max_by_key(|&n| candidates[n].keeps);
    Choice::Take { scheme: most.unwrap_or(cheapest), cheapest }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A scheme with this cost, to this factor either way.
    fn candidate(scheme: &str, cost_s: f64, width: f64, defect: Option<f64>) -> Candidate {
        let measured = Measured { steps: 8, error: 1e-3, lo: 9e-4, hi: 1.1e-3, step_ns: 1.0 };
        let (cost_lo, cost_hi) = (cost_s / width, Some(cost_s * width));
        let outcome = Outcome::Reached { steps: 8.0, cost_s, cost_lo, cost_hi, measured };
        let keeps = Keeps::default();
        let candidate = Candidate { scheme: scheme.to_owned(), outcome, defect, keeps };
        Candidate { keeps: Keeps::of(&candidate, true), ..candidate }
    }

    #[test]
    fn a_scheme_that_keeps_more_is_taken_unless_it_costs_significantly_more() {
        let (kept, lost) = (Some(1e-14), Some(1e-3));
        let take = |scheme, cheapest| Choice::Take { scheme, cheapest };
        // The body of six dimensions: 1.16 [0.62, 2.21], and `sexp` dearer by far.
        let width = 1.9f64.sqrt();
        let mut body = vec![
            candidate("heun", 1.0, width, lost),
            candidate("sexp-li", 1.16, width, kept),
            candidate("sexp", 3.0, width, kept),
        ];
        assert_eq!(choose(&body), take(1, 0));
        // With wider intervals the energy is kept as well.
        body[2] = candidate("sexp", 2.0, width, kept);
        assert_eq!(choose(&body), take(2, 0));
        // 1.11 times the cost with 95 %, and 1.09 times.
        let near =
            |ratio: f64| [candidate("heun", 1.0, 1.0, lost), candidate("sexp", ratio, 1.0, kept)];
        assert_eq!([choose(&near(1.11)), choose(&near(1.09))], [take(0, 0), take(1, 0)]);
        // Casimirs first, then the energy, then the damping; of equals the cheapest.
        let order =
            ["em", "midpoint", "nv", "sexp"].map(|scheme| candidate(scheme, 1.0, 2.0, None));
        assert_eq!(
            (choose(&order), choose(&order[..3]), choose(&order[..2])),
            (take(3, 0), take(2, 0), take(0, 0),)
        );
        let casimirs = [candidate("sexp", 1.0, 2.0, lost), candidate("sexp-li", 1.2, 2.0, kept)];
        assert_eq!(choose(&casimirs), take(1, 0));
        let outcome = Outcome::Inconsistent(0.5);
        let wrong = Candidate { outcome, ..candidate("sexp", 1.0, 1.0, kept) };
        assert_eq!(choose(&[wrong.clone(), candidate("heun", 2.0, 1.0, lost)]), take(1, 1));
        assert_eq!(choose(&[wrong]), Choice::NoneReaches);
    }

    #[test]
    fn a_coarsest_step_that_does_is_enough() {
        assert_eq!(least_cost(&[(0.1, 1.0), (0.05, 2.0)], 0.2), Some(1.0));
        assert_eq!(least_cost(&[(0.1, 1.0), (0.05, 2.0)], 0.05), Some(2.0));
        assert_eq!(least_cost(&[(0.1, 1.0), (0.05, 2.0)], 0.01), None);
        assert_eq!(least_cost(&[], 0.01), None);
    }
}
