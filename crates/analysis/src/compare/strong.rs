//! Strong errors against a reference whose own error is estimated.

use mc::{LadderError, View};
use real::Row;
use serde::{Deserialize, Serialize};
use stats::{CrossMoments, root_mean_square_interval};

use super::{
    cost::Curve,
    grid::{Grid, REFERENCES, Sampled, Series, Timed},
    laws::Law,
    own_areas::terms,
    time::Time,
};
use crate::{inspect::Form, orders::squared_distance};

/// Strong errors of several schemes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Strong {
    /// Paths and reference.
    #[serde(flatten)]
    pub sampled: Sampled,
    /// A bound of the error of the reference: (E|y_ref − y(T)|²)^½ with 95 %. It is in every
    /// interval.
    pub reference_error: f64,
    /// (E|y_τ − y_{2τ}|²)^½ of the reference at its finest two step sizes.
    #[serde(default)]
    pub last_difference: f64,
    /// (E|y(T) − y′(T)|²)^½ of two independent paths of the reference. Differences of step sizes
    /// that are nearly as large say that paths have parted.
    #[serde(default)]
    pub spread: f64,
    /// A curve for each scheme.
    pub series: Vec<Series<StrongPoint>>,
}

/// The strong error of one scheme at one step size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StrongPoint {
    /// Steps of a path.
    pub steps: u64,
    /// Step size.
    pub tau: f64,
    /// (E|y_N − y_ref|²)^½.
    pub error: f64,
    /// Its standard error.
    pub se: f64,
    /// Lower end of the interval of (E|y_N − y(T)|²)^½: bootstrap-t of 95 %, less the error of the
    /// reference. None with fewer than 32 paths.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lo: Option<f64>,
    /// Upper end, with the error of the reference added.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hi: Option<f64>,
    /// Whether the error of the reference is at most a quarter of this one. Other points are not
    /// used.
    pub resolved: bool,
    /// Its error over that of the base scheme with as many steps on the same paths, where both are
    /// resolved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ratio: Option<Ratio>,
    /// Of a scheme with Lévy areas: the error with exact areas of the step. `error` includes what
    /// the approximation of areas at the step itself may add.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_exact_areas: Option<f64>,
    /// Of a scheme with Lévy areas: terms of the series behind an area.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub area_terms: Option<usize>,
    /// For each invariant F, (E|F(y_N)/(e^{−p∫γ}F(y₀)) − 1|²)^½: its relative distance from the
    /// conformal law; the absolute one over e^{−p∫γ} if F(y₀) = 0.
    pub defects: Vec<f64>,
    /// Processor time of one path, where it was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<Time>,
}

/// A ratio of two errors on the same paths.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ratio {
    /// The ratio.
    pub value: f64,
    /// Lower end of its 95 % interval, which is narrower than those of the errors allow: chance
    /// that both share cancels. The error of the reference is in it.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
}

impl Ratio {
    /// √(mᵢ/mⱼ) of two mean squares of `squares`, against a reference with this error ρ.
    ///
    /// The variance of ½(ln mᵢ − ln mⱼ) is ¼(vᵢᵢ/mᵢ² + vⱼⱼ/mⱼ² − 2vᵢⱼ/(mᵢmⱼ)), with the covariances
    /// v of the means; the triangle inequality moves each error by ρ at most. None with fewer than
    /// 32 paths, and where ρ is more than a quarter of an error.
    fn of(squares: &CrossMoments, i: usize, j: usize, reference: f64) -> Option<Self> {
        let [one, other] = [i, j].map(|k| squares.mean(k).sqrt());
        let few = squares.count() < LEAST_PATHS;
        // True for NaN.
        let unresolved = |error: f64| !(error > 0.0 && reference <= RESOLVED * error);
        if few || unresolved(one) || unresolved(other) {
            return None;
        }
        let relative = |a: usize, b: usize| {
            squares.covariance_of_means(a, b) / (squares.mean(a) * squares.mean(b))
        };
        let variance = 0.25 * (relative(i, i) + relative(j, j) - 2.0 * relative(i, j));
        let reach = (QUANTILE * variance.max(0.0).sqrt()).exp();
        Some(Self {
            value: one / other,
            lo: (one - reference) / (other + reference) / reach,
            hi: (one + reference) / (other - reference) * reach,
        })
    }
}

/// The part of an error that the error of the reference may be.
const RESOLVED: f64 = 0.25;
/// Paths whose distance is this part of that of independent ones have parted.
const PARTED: f64 = 0.25;
/// Two-sided 95 % quantile of the normal distribution.
const QUANTILE: f64 = 1.96;
/// Paths without which there is no interval.
const LEAST_PATHS: u64 = 32;

/// A bound of the error at the finest of three step sizes from the root-mean-square differences of
/// successive ones, d₁ = |y_{4τ} − y_{2τ}| and d₀ = |y_{2τ} − y_τ|: Σ of those that would follow,
/// d₀/(2^p − 1) with p = log₂(d₁/d₀), at most 1 and at least ½. Infinite if they do not fall.
pub(super) fn left(before: f64, last: f64) -> f64 {
    const FALLS: f64 = 0.25;
    let p = (before / last).log2();
    match last {
        0.0 => 0.0,
        _ if p >= FALLS => last / (p.clamp(0.5, 1.0).exp2() - 1.0),
        _ => f64::INFINITY,
    }
}

impl StrongPoint {
    /// The point whose squared errors are component `index` of `squares`, against a reference with
    /// this error.
    fn new(tau: f64, steps: u64, squares: &CrossMoments, index: usize, reference: f64) -> Self {
        let error = squares.mean(index).sqrt();
        let se = squares.covariance_of_means(index, index).sqrt() / (2.0 * error);
        let interval = root_mean_square_interval(squares, index);
        let (lo, hi) = interval.map(|(lo, hi)| ((lo - reference).max(0.0), hi + reference)).unzip();
        Self {
            steps,
            tau,
            error,
            se,
            lo,
            hi,
            resolved: reference <= RESOLVED * error,
            ratio: None,
            error_exact_areas: None,
            area_terms: None,
            defects: Vec::new(),
            time: None,
        }
    }
}

impl Timed for StrongPoint {
    fn steps(&self) -> u64 {
        self.steps
    }
    fn set_time(&mut self, time: Time) {
        self.time = Some(time);
    }
}

impl Series<StrongPoint> {
    /// (error, seconds of a path) of the points that are resolved and timed.
    pub fn curve(&self) -> Curve {
        self.curve_of(|point| Some((point.error, point.time?.min_s)))
    }

    /// Pairs of errors and something else, of the points that are resolved.
    pub(super) fn curve_of(&self, pair: impl Fn(&StrongPoint) -> Option<(f64, f64)>) -> Curve {
        let points = self.points.iter().filter(|point| point.resolved).filter_map(pair);
        Curve { scheme: self.scheme.clone(), points: points.collect() }
    }
}

impl Strong {
    /// Strong errors at the final time of all schemes of a grid, with the defects of the invariants
    /// that the system names and of Casimirs that were `found`. Nothing is timed.
    ///
    /// Errors are root-mean-square distances to the reference on the same noise. The error of the
    /// reference is estimated from its own differences and enters every interval by the triangle
    /// inequality. A scheme that reads Lévy areas gets those of a ladder with the error that areas
    /// have when they are drawn at its own step. The points of all schemes but the one with the
    /// number `base` have the ratio of their error to its error with as many steps.
    ///
    /// # Errors
    /// [`LadderError`] when there is no step, or when truncation or areas are not defined at a step
    /// size.
    pub fn measure(
        grid: &Grid<'_>,
        found: &[Form],
        base: Option<usize>,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Self, LadderError> {
        let laws = Law::all(grid.problem, found);
        let (points, exact) = (grid.points(), grid.exact_points());
        // Differences of the reference and of neighbouring paths, squared errors of every run,
        // squared defects of every point.
        let (own, runs) = (REFERENCES, points + exact);
        let values = |view: &View<'_>, values: &mut [Row]| {
            let state = |run: usize| view.state(run);
            for (k, value) in values[..own - 1].iter_mut().enumerate() {
                *value = squared_distance(state(k), state(k + 1), view.live);
            }
            let (mut other, y) = (view.live.paths().last().unwrap_or(0), state(0));
            for p in view.live.paths() {
                values[own - 1][p] = y.iter().map(|row| (row[p] - row[other]).powi(2)).sum();
                other = p;
            }
            let (squares, defects) = values[own..].split_at_mut(runs);
            for (run, square) in squares.iter_mut().enumerate() {
                *square = squared_distance(state(REFERENCES + run), state(0), view.live);
            }
            for (run, defects) in (0..points).zip(defects.chunks_exact_mut(laws.len().max(1))) {
                for p in view.live.paths() {
                    let y: Vec<f64> = state(REFERENCES + run).iter().map(|row| row[p]).collect();
                    for (defect, law) in defects.iter_mut().zip(&laws) {
                        defect[p] = law.defect(&y).powi(2);
                    }
                }
            }
        };
        let length = own + runs + points * laws.len();
        let (moments, mut sampled) = grid.moments(true, length, &values, progress)?;
        let rms = |index: usize| moments.mean(index).sqrt();
        let last = root_mean_square_interval(&moments, 0).map_or(rms(0), |(_, hi)| hi);
        let reference_error = left(rms(1), rms(0)) * (last / rms(0)).max(1.0);
        let reference_error = if rms(0) > 0.0 { reference_error } else { 0.0 };
        let [steps, ..] = grid.reference_steps();
        sampled.reference += &format!(" with {steps} steps on the same noise");
        let point = |number: usize, exact: Option<usize>, steps: u64| {
            let tau = grid.problem.t_end / steps as f64;
            let point = StrongPoint::new(tau, steps, &moments, own + number, reference_error);
            let first = own + runs + number * laws.len();
            let base = base.and_then(|base| grid.point_number(base, steps));
            let base = base.filter(|&base| base != number);
            StrongPoint {
                ratio: base.and_then(|base| {
                    Ratio::of(&moments, own + number, own + base, reference_error)
                }),
                error_exact_areas: exact.map(|exact| rms(own + exact)),
                area_terms: exact.and_then(|_| terms(tau, grid.problem.noises)),
                defects: (first..first + laws.len()).map(rms).collect(),
                ..point
            }
        };
        let (last_difference, spread) = (rms(0), rms(own - 1));
        let series = grid.series(point);
        Ok(Self { series, reference_error, last_difference, spread, sampled })
    }

    /// No errors of these schemes.
    pub(super) fn nothing(schemes: &[&str]) -> Self {
        let none = |scheme: &&str| Series { scheme: (*scheme).to_owned(), points: Vec::new() };
        let (samples, failed, failures, reference) = (0, 0, Vec::new(), String::new());
        Self {
            sampled: Sampled { samples, failed, failures, reference },
            reference_error: f64::INFINITY,
            last_difference: 0.0,
            spread: 0.0,
            series: schemes.iter().map(none).collect(),
        }
    }

    /// Whether paths of the reference part: at its finest two step sizes they are as far apart as
    /// independent ones, nearly.
    pub fn parts(&self) -> bool {
        self.last_difference > PARTED * self.spread
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_of_errors_are_those_of_the_same_paths() {
        // Four times the other square, and one of its own.
        let mut squares = CrossMoments::new(3);
        for path in 0..64 {
            let x = 1.0 + f64::from(path % 7);
            squares.add(&[4.0 * x, x, 1.0 + f64::from(path * path % 11)]);
        }
        let of = |i, j, reference| Ratio::of(&squares, i, j, reference);
        // All of the chance is shared: the ratio is known.
        let shared = of(0, 1, 0.0).unwrap();
        for x in [shared.value, shared.lo, shared.hi] {
            assert!((x - 2.0).abs() < 1e-7, "{shared:?}");
        }
        // By hand from the variance of the logarithms, one by one.
        let apart = of(0, 2, 0.0).unwrap();
        let log = |path: usize, i: usize| {
            let x = [4.0 * (1.0 + (path % 7) as f64), 0.0, 1.0 + (path * path % 11) as f64][i];
            0.5 * x / squares.mean(i)
        };
        let differences: Vec<f64> = (0..64).map(|path| log(path, 0) - log(path, 2)).collect();
        let variance = differences.iter().map(|x| x * x).sum::<f64>() / 63.0 / 64.0;
        let reach = (1.96 * variance.sqrt()).exp();
        assert!((apart.hi / (apart.value * reach) - 1.0).abs() < 1e-12, "{apart:?} {reach}");
        assert!((apart.lo * reach / apart.value - 1.0).abs() < 1e-12, "{apart:?} {reach}");
        // An error of the reference of a tenth of the smaller error: (2 ∓ 0.1)/(1 ± 0.1).
        let widened = of(0, 1, 0.1 * squares.mean(1).sqrt()).unwrap();
        assert!((widened.lo - 1.9 / 1.1).abs() < 1e-7 && (widened.hi - 2.1 / 0.9).abs() < 1e-7);
        assert_eq!(of(0, 1, 0.26 * squares.mean(1).sqrt()), None);
        assert_eq!(of(0, 1, f64::INFINITY), None);
        assert_eq!(Ratio::of(&CrossMoments::new(2), 0, 1, 0.0), None);
    }
}
