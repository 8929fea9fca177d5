//! Which scheme to take, from errors and times.

use real::elementary::{ln, log2, powf};
use schemes::{BuiltIn, Energy, Explicitness, Properties};
use serde::{Deserialize, Serialize};

use super::ErrorPoint;
use crate::Spread;

/// Results of a scheme at the wanted error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Candidate {
    /// Identifier of the scheme.
    pub scheme: String,
    /// Error required of the scheme: half of the wanted one where it reads Lévy areas, since it is
    /// measured with better areas than it would draw.
    pub asked: f64,
    /// Errors of the scheme, coarsest step size first.
    pub points: Vec<ErrorPoint>,
    /// Whether the scheme reaches the error, and its cost.
    pub outcome: Outcome,
    /// Properties that the scheme conserves over long times.
    pub keeps: Keeps,
}

/// Properties that a scheme conserves over long times; a scheme that conserves more is larger.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Keeps {
    /// Whether the laws of all known Casimirs hold to rounding, as measured.
    pub casimirs: bool,
    /// Whether the energy H₀ is conserved without noise and damping.
    pub energy: bool,
    /// Whether the damping is exact; without damping, whether the scheme is not explicit, since
    /// energies of explicit schemes grow exponentially.
    pub conformal: bool,
}

/// Whether a scheme reaches the wanted error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// Reaches the wanted error.
    Reached {
        /// Steps of a path for the wanted error, interpolated between those measured; an upper
        /// bound if the coarsest steps reach it.
        steps: f64,
        /// Seconds of processor time of a path.
        cost_s: f64,
        /// Lower end of the interval of `cost_s`, from the intervals of errors and times.
        cost_lo: f64,
        /// Upper end of the interval; `None` where the errors do not reach far enough.
        cost_hi: Option<f64>,
    },
    /// Does not reach the wanted error with the steps that were measured.
    NotReached {
        /// Steps that the wanted error needs, extrapolated from the last errors; `None` where
        /// these do not fall.
        needs: Option<f64>,
    },
    /// The budget was too short for a first error.
    NotMeasured,
    /// Inconsistent: single steps miss the coefficients of the equation as τ → 0 by this part, and
    /// the scheme converges to something else.
    Inconsistent(f64),
    /// Fails: some path fails at every step size; with the message of the first failure.
    Fails(String),
}

/// Choice of a scheme, or the reason why there is none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Choice {
    /// Takes one of the candidates.
    Take {
        /// Index of the scheme among the candidates.
        scheme: usize,
        /// Index of the cheapest scheme. Another one is taken if it conserves more and does not
        /// cost significantly more.
        cheapest: usize,
    },
    /// No scheme reaches the error.
    NoneReaches,
    /// Wrong reference: its single steps miss the coefficients of the equation by this part, so
    /// that distances to it are not errors.
    WrongReference(f64),
    /// The finest steps do not resolve a function of t near this time: errors may be larger than
    /// any measured.
    NotResolved(f64),
}

/// Relative defect below which a Casimir counts as conserved: only rounding is left.
const KEPT: f64 = 1e-10;
/// Cost ratio up to which a scheme that conserves more is taken, with 95 %.
const WORTH: f64 = 1.1;
/// Errors that fall with less than this exponent of the step size are not extrapolated.
const FALLS: f64 = 0.3;

impl Candidate {
    /// Judges a scheme by its errors, unless something excludes it.
    pub(super) fn new(
        scheme: &str,
        points: Vec<ErrorPoint>,
        asked: f64,
        excluded: Option<Outcome>,
        damped: bool,
    ) -> Self {
        let outcome = excluded.unwrap_or_else(|| outcome(&points, asked));
        let (id, mut keeps) = (scheme.to_owned(), Keeps::default());
        let candidate = Self { scheme: id, asked, points, outcome, keeps };
        let defect = candidate.point().and_then(|point| point.defect);
        keeps.casimirs = defect.is_some_and(|defect| defect <= KEPT);
        if let Some(scheme) = BuiltIn::named(scheme) {
            let Properties { explicit, exact_damping, energy, .. } = scheme.properties();
            keeps.energy = energy == Energy::Kept;
            keeps.conformal = match explicit {
                Explicitness::Always => false,
                Explicitness::WhereConstant => damped || keeps.casimirs,
                Explicitness::No => exact_damping || !damped,
            };
        }
        Self { keeps, ..candidate }
    }

    /// Measured point next to the wanted error, or the last one.
    pub fn point(&self) -> Option<&ErrorPoint> {
        let mut resolved = self.points.iter().filter(|point| point.counts(self.asked));
        match self.outcome {
            Outcome::Reached { steps, .. } => resolved.find(|point| point.steps as f64 >= steps),
            // Without a resolved point, the distance from a reference that is wrong as well.
            _ => resolved.next_back().or(self.points.last()),
        }
    }

    /// Seconds that the wanted error would cost, extrapolated, where it is not reached.
    pub(super) fn extrapolated_s(&self) -> Option<f64> {
        let Outcome::NotReached { needs } = self.outcome else { return None };
        let point = self.point()?;
        Some(needs? * (point.time?.best / point.steps as f64))
    }

    /// Cost in seconds with the ends of its interval, if the error is reached.
    pub(super) fn cost(&self) -> Option<(f64, f64, Option<f64>)> {
        match self.outcome {
            Outcome::Reached { cost_s, cost_lo, cost_hi, .. } => Some((cost_s, cost_lo, cost_hi)),
            _ => None,
        }
    }

    /// Ratio of the cost of this scheme to that of `other`, with its interval, which may have no
    /// upper end. `None` unless both reach the error.
    pub fn ratio(&self, other: &Self) -> Option<(f64, f64, Option<f64>)> {
        let ((a, a_lo, a_hi), (b, b_lo, b_hi)) = (self.cost()?, other.cost()?);
        let hi = a_hi.filter(|_| b_lo > 0.0).map(|hi| hi / b_lo);
        Some((a / b, b_hi.map_or(0.0, |hi| a_lo / hi), hi))
    }
}

/// Judges a scheme by its errors at several numbers of steps, coarsest first.
fn outcome(points: &[ErrorPoint], wanted: f64) -> Outcome {
    let resolved: Vec<&ErrorPoint> = points.iter().filter(|point| point.counts(wanted)).collect();
    let Some(last) = resolved.last().copied().or(points.last()) else {
        return Outcome::NotMeasured;
    };
    let at = |of: fn(&ErrorPoint, Spread) -> [f64; 2]| {
        let rows = resolved.iter().filter_map(|point| {
            let [error, seconds] = of(point, point.time?);
            Some([error, point.steps as f64, seconds])
        });
        cost(rows.collect(), wanted)
    };
    if let Some((steps, cost_s)) = at(|point, time| [point.error, time.best]) {
        let cost_lo = at(|point, time| [point.lo, time.best]).map_or(0.0, |lo| lo.1.min(cost_s));
        let cost_hi = at(|point, time| [point.hi, time.median]).map(|hi| hi.1);
        return Outcome::Reached { steps, cost_s, cost_lo, cost_hi };
    }
    // Over up to three halvings: errors of one step size are known to a tenth or so.
    let halvings = resolved.len().saturating_sub(1).min(3);
    let before = resolved.iter().rev().nth(halvings).filter(|_| halvings > 0);
    let needs = before.and_then(|before| {
        let p = log2(before.error / last.error) / halvings as f64;
        let factor = powf(last.error / wanted, 1.0 / p.clamp(0.5, 1.0));
        (p >= FALLS).then_some(last.steps as f64 * factor.max(1.0))
    });
    Outcome::NotReached { needs }
}

/// Interpolates steps and seconds for the wanted error from rows (error, steps, seconds), coarsest
/// first, linearly in the logarithms: between the last two neighbours around the error. If all
/// errors are below it, the coarsest row is the result. Nothing is extrapolated.
fn cost(mut rows: Vec<[f64; 3]>, wanted: f64) -> Option<(f64, f64)> {
    let &[_, steps, seconds] = rows.first()?;
    if rows.iter().all(|[error, ..]| *error <= wanted) {
        return Some((steps, seconds));
    }
    // Errors of zero have no logarithm.
    rows.retain(|[error, _, cost]| error.min(*cost) > 0.0);
    let mut pairs = rows.windows(2).rev().map(|pair| (pair[0], pair[1]));
    let (a, b) = pairs.find(|(a, b)| b[0] <= wanted && wanted <= a[0])?;
    let share = if a[0] == b[0] { 1.0 } else { ln(wanted / a[0]) / ln(b[0] / a[0]) };
    let between = |k: usize| a[k] * powf(b[k] / a[k], share);
    Some((between(1), between(2)))
}

/// Chooses the candidate that conserves most, of those not significantly dearer than the cheapest;
/// of equals the cheapest.
pub fn choose(candidates: &[Candidate]) -> Choice {
    let cost = |n: &usize| candidates[*n].cost().map_or(f64::INFINITY, |(cost, ..)| cost);
    let reached = || (0..candidates.len()).filter(|&n| candidates[n].cost().is_some());
    let Some(cheapest) = reached().min_by(|a, b| cost(a).total_cmp(&cost(b))) else {
        return Choice::NoneReaches;
    };
    // Without an interval the value decides.
    let near = |n: &usize| {
        let ratio = candidates[*n].ratio(&candidates[cheapest]);
        ratio.is_some_and(|(ratio, lo, _)| WORTH >= if lo > 0.0 { lo } else { ratio })
    };
    let most = reached().filter(|n| *n == cheapest || near(n)).min_by(|a, b| {
        candidates[*b].keeps.cmp(&candidates[*a].keeps).then(cost(a).total_cmp(&cost(b)))
    });
    Choice::Take { scheme: most.unwrap_or(cheapest), cheapest }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(steps: u64, error: f64) -> ErrorPoint {
        let time = steps as f64;
        ErrorPoint {
            steps,
            error,
            lo: 0.5 * error.abs(),
            hi: error.abs(),
            resolved: true,
            defect: None,
            time: Some(Spread { best: time, median: time, worst: time }),
        }
    }

    /// Where the reference does not resolve an error, its upper end counts.
    #[test]
    fn a_scheme_that_is_better_than_its_reference_shows_reaches_the_error() {
        let close = ErrorPoint { resolved: false, ..point(32, 1e-4) };
        let points = [point(8, 1e-2), point(16, 2e-3), close];
        let Outcome::Reached { steps, .. } = outcome(&points, 5e-4) else { panic!("{points:?}") };
        assert!(16.0 < steps && steps < 32.0, "{steps}");
        let needs = outcome(&points, 5e-5);
        assert!(matches!(needs, Outcome::NotReached { needs: Some(_) }), "{needs:?}");
    }

    /// A scheme with this cost, to this factor either way.
    fn candidate(scheme: &str, cost_s: f64, width: f64, defect: Option<f64>) -> Candidate {
        let (cost_lo, cost_hi) = (cost_s / width, Some(cost_s * width));
        let outcome = Outcome::Reached { steps: 8.0, cost_s, cost_lo, cost_hi };
        let points = vec![ErrorPoint { defect, ..point(8, 1e-3) }];
        Candidate::new(scheme, points, 1e-3, Some(outcome), true)
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

    /// Steps and seconds of an error, where a step takes a second.
    fn of(points: &[ErrorPoint], wanted: f64) -> Option<(f64, f64)> {
        let row = |point: &ErrorPoint| Some([point.error, point.steps as f64, point.time?.best]);
        cost(points.iter().filter_map(row).collect(), wanted)
    }

    #[test]
    fn a_coarsest_step_that_does_is_enough() {
        let points = [point(1, 0.1), point(2, 0.05)];
        assert_eq!(of(&points, 0.2), Some((1.0, 1.0)));
        assert_eq!(of(&points, 0.05), Some((2.0, 2.0)));
        assert_eq!((of(&points, 0.01), of(&[], 0.01)), (None, None));
    }

    #[test]
    fn power_laws_are_interpolated_exactly() {
        for (order, scale) in [(0.5, 3.0), (1.0, 0.2)] {
            let curve: Vec<_> =
                (0..7).map(|k| point(1 << k, scale * 0.5f64.powf(order * f64::from(k)))).collect();
            for share in [0.0, 0.3, 2.7, 6.0] {
                let (steps, seconds) = of(&curve, scale * 0.5f64.powf(order * share)).unwrap();
                assert!((steps / share.exp2() - 1.0).abs() < 1e-12, "{order} {share}");
                assert_eq!(steps, seconds);
            }
            assert_eq!(of(&curve, 0.5 * curve[6].error), None);
            // An eighth of the last error takes 8^{1/order} as many steps.
            let further = outcome(&curve, 0.125 * curve[6].error);
            let Outcome::NotReached { needs: Some(needs) } = further else { panic!() };
            assert!((needs / (64.0 * 8f64.powf(1.0 / order)) - 1.0).abs() < 1e-12, "{order}");
        }
    }

    #[test]
    fn a_curve_that_turns_is_read_on_its_dear_side() {
        // The coarsest step happens to be accurate; the error has to stay below the wanted one from
        // there on.
        assert_eq!(of(&[point(1, 0.01), point(2, 0.1), point(4, 0.01)], 0.01), Some((4.0, 4.0)));
        // Of two points with one error the later is taken, and none without a time or an error.
        assert_eq!(of(&[point(1, 0.2), point(2, 0.1), point(4, 0.1)], 0.1), Some((4.0, 4.0)));
        let untimed = ErrorPoint { time: None, ..point(1, 0.1) };
        assert_eq!(of(&[untimed, point(2, 0.01)], 0.05), Some((2.0, 2.0)));
        assert_eq!(of(&[point(1, 0.0), point(2, 0.01)], 0.005), None);
    }
}
