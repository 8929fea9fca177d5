//! Strong errors against a reference whose own error is estimated.

use mc::{LadderError, View, squared_distance};
use serde::{Deserialize, Serialize};
use stats::{CrossMoments, root_mean_square_interval};
use systems::{Damping, PoissonSystem};

use super::{
    cost::Curve,
    grid::{Grid, REFERENCES, Sampled, Series, Timed},
    laws::Law,
    own_areas::terms,
    time::Time,
};
use crate::inspect::FoundCasimir;

/// Strong errors of several schemes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Strong {
    /// Paths and reference.
    #[serde(flatten)]
    pub sampled: Sampled,
    /// A bound of the error of the reference: (E|y_ref − y(T)|²)^½ with 95 %. It is in every
    /// interval.
    pub reference_error: f64,
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

/// The part of an error that the error of the reference may be.
const RESOLVED: f64 = 0.25;

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
    /// have when they are drawn at its own step.
    ///
    /// # Errors
    /// [`LadderError`] when there is no step, or when truncation or areas are not defined at a step
    /// size.
    pub fn measure<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
        grid: &Grid<'_, S, G, D, M>,
        found: &[FoundCasimir],
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Self, LadderError> {
        let laws = Law::all(grid.problem, found);
        let (points, exact) = (grid.points(), grid.exact_points());
        // Differences of the reference, squared errors of every run, squared defects of every
        // point.
        let (own, runs) = (REFERENCES - 1, points + exact);
        let values = |view: &View<'_, D>, p: usize, values: &mut [f64]| {
            let state = |run: usize| view.states[run].path(p);
            for (k, value) in values[..own].iter_mut().enumerate() {
                *value = squared_distance(state(k), state(k + 1));
            }
            let (squares, defects) = values[own..].split_at_mut(runs);
            for (run, square) in squares.iter_mut().enumerate() {
                *square = squared_distance(state(REFERENCES + run), state(0));
            }
            for (run, defects) in (0..points).zip(defects.chunks_exact_mut(laws.len().max(1))) {
                for (defect, law) in defects.iter_mut().zip(&laws) {
                    *defect = law.defect(state(REFERENCES + run)).powi(2);
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
            let tau = grid.problem.t_end() / steps as f64;
            let point = StrongPoint::new(tau, steps, &moments, own + number, reference_error);
            let first = own + runs + number * laws.len();
            StrongPoint {
                error_exact_areas: exact.map(|exact| rms(own + exact)),
                area_terms: exact.and_then(|_| terms(tau, M)),
                defects: (first..first + laws.len()).map(rms).collect(),
                ..point
            }
        };
        Ok(Self { series: grid.series(point), reference_error, sampled })
    }
}
