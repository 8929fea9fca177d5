//! The contract of `work-precision.json`; documented for other languages in `docs/results.md`.

use lab::setups::Kind;
use serde::Serialize;
use verify::{
    results::Provenance,
    work_precision::{Time, WorkPoint},
};

/// Raised whenever a reader of an older version would misread a newer one.
pub const SCHEMA: u32 = 1;

/// Everything measured.
#[derive(Serialize)]
pub struct Measurements {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Where it comes from.
    pub provenance: Provenance,
    /// What the times are, in words.
    pub clock: &'static str,
    /// The cases.
    pub cases: Vec<Case>,
}

/// One problem.
#[derive(Serialize)]
pub struct Case {
    /// Identifier, for example `rigid-body-3`.
    pub id: &'static str,
    /// What it is called on a figure.
    pub title: &'static str,
    /// Parameters in words.
    pub setup: String,
    /// The invariants whose conformal defect is measured, in the order of the system; none where it
    /// has none.
    pub invariants: Vec<&'static str>,
    /// Strong errors.
    pub strong: Strong,
    /// Weak errors.
    pub weak: Weak,
}

/// What strong and weak errors of a case share.
#[derive(Serialize)]
pub struct Sampled {
    /// Paths behind every error.
    pub samples: u64,
    /// Paths that were left out because some scheme at some step size had no solution or was not
    /// finite.
    pub failed: u64,
    /// The first few of them.
    pub failures: Vec<String>,
    /// What errors are measured against.
    pub reference: String,
}

/// Strong errors of a case.
#[derive(Serialize)]
pub struct Strong {
    #[serde(flatten)]
    pub sampled: Sampled,
    /// One curve for each scheme.
    pub series: Vec<Series<StrongPoint>>,
}

/// The errors of one scheme, coarsest step first.
#[derive(Serialize)]
pub struct Series<P> {
    /// What the scheme is.
    #[serde(skip)]
    pub kind: Kind,
    /// `sexp`, `sexp-levy`, `midpoint`, `heun` or `em`.
    pub scheme: &'static str,
    /// A point for each step size.
    pub points: Vec<P>,
    /// Of weak errors: what estimates of several accuracies cost, the least accurate first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub costs: Option<Vec<Cost>>,
}

/// The strong error of one scheme at one step size.
#[derive(Serialize)]
pub struct StrongPoint {
    #[serde(flatten)]
    pub work: WorkPoint,
    /// Of a scheme with Lévy areas: the error with exact areas of the step. `error` includes what
    /// the approximation of areas at the step itself may add.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_exact_areas: Option<f64>,
    /// Of a scheme with Lévy areas: terms of the series behind an area.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area_terms: Option<usize>,
    /// For each of the case's invariants, (E|F(y_N)/(e^{−p∫γ}F(y₀)) − 1|²)^½: its relative distance
    /// from the conformal law.
    pub defects: Vec<f64>,
}

/// Weak errors of a case.
#[derive(Serialize)]
pub struct Weak {
    #[serde(flatten)]
    pub sampled: Sampled,
    /// The test functions.
    pub observables: Vec<WeakObservable>,
}

/// Weak errors for one test function.
#[derive(Serialize)]
pub struct WeakObservable {
    /// For example `y1` or `cos y3`.
    pub name: &'static str,
    /// E φ(y(T)) without sampling, where it is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exact: Option<f64>,
    /// The reference's E φ(y(T)).
    pub reference_mean: f64,
    /// Its standard error.
    pub reference_se: f64,
    /// One curve for each scheme.
    pub series: Vec<Series<WeakPoint>>,
}

/// The weak error of one scheme at one step size.
#[derive(Serialize)]
pub struct WeakPoint {
    /// Steps of a path.
    pub steps: u64,
    /// Step size.
    pub tau: f64,
    /// E φ(y_N) − E φ(y(T)).
    pub bias: f64,
    /// Its standard error.
    pub se: f64,
    /// Standard deviation of φ(y_N).
    pub standard_deviation: f64,
    /// Time of one path.
    pub time: Time,
}

/// The cheapest plain Monte Carlo estimate of a given root-mean-square error among the measured
/// step sizes.
#[derive(Serialize)]
pub struct Cost {
    /// (bias² + variance/paths)^½, where the bias is taken at the upper end of its 95 % interval.
    pub accuracy: f64,
    /// Steps of a path.
    pub steps: u64,
    /// Paths: variance/(accuracy² − bias²), at least one.
    pub paths: f64,
    /// Its processor time in seconds: paths times the time of one.
    pub cost_s: f64,
}

/// Errors of a scheme against their costs.
pub struct Curve {
    /// The scheme.
    pub scheme: &'static str,
    /// (error, cost) by increasing cost.
    pub points: Vec<(f64, f64)>,
}

impl Series<StrongPoint> {
    /// (error, microseconds of a path).
    pub fn curve(&self) -> Curve {
        let point = |point: &StrongPoint| (point.work.error, 1e6 * point.work.time.min_s);
        Curve { scheme: self.scheme, points: self.points.iter().map(point).collect() }
    }
}

impl Strong {
    /// The curves of all schemes.
    pub fn curves(&self) -> Vec<Curve> {
        self.series.iter().map(Series::<StrongPoint>::curve).collect()
    }
}

impl WeakObservable {
    /// (accuracy, seconds of an estimate) of all schemes.
    pub fn curves(&self) -> Vec<Curve> {
        let curve = |series: &Series<WeakPoint>| {
            let costs = series.costs.iter().flatten();
            let points = costs.map(|cost| (cost.accuracy, cost.cost_s)).collect();
            Curve { scheme: series.scheme, points }
        };
        self.series.iter().map(curve).collect()
    }
}

/// Two-sided 95 % quantile of the normal distribution.
const QUANTILE: f64 = 1.96;
/// Accuracies 10^{−k/4} for k up to this are looked at.
const FINEST: i32 = 28;

/// What estimates of the accuracies 10^{−k/4} cost, from half the standard deviation downwards,
/// where a single path says next to nothing, to what the bias allows.
pub fn costs(points: &[WeakPoint]) -> Vec<Cost> {
    let spread = points.last().map_or(0.0, |point| point.standard_deviation);
    (0..=FINEST)
        .map(|k| 10f64.powf(-0.25 * f64::from(k)))
        .filter(|&accuracy| accuracy <= 0.5 * spread)
        .filter_map(|accuracy| {
            let of = |point: &WeakPoint| {
                let bias = point.bias.abs() + QUANTILE * point.se;
                let variance = point.standard_deviation * point.standard_deviation;
                let paths = f64::max(variance / (accuracy * accuracy - bias * bias), 1.0);
                let cost_s = paths * point.time.min_s;
                (bias < accuracy).then_some(Cost { accuracy, steps: point.steps, paths, cost_s })
            };
            points.iter().filter_map(of).min_by(|a, b| a.cost_s.total_cmp(&b.cost_s))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::{assert_relative_eq, relative_eq};

    #[test]
    fn an_estimate_takes_the_step_that_is_cheapest_for_it() {
        let time =
            |s| Time { min_s: s, median_s: s, max_s: s, repetitions: 1, paths: 1, failed: 0 };
        let point = |steps: u64, bias: f64| WeakPoint {
            steps,
            tau: 1.0 / steps as f64,
            bias,
            se: 0.0,
            standard_deviation: 1.0,
            time: time(steps as f64),
        };
        let found = costs(&[point(1, -0.05), point(2, 0.025), point(4, 0.0125)]);
        let at = |accuracy: f64| found.iter().find(|cost| relative_eq!(cost.accuracy, accuracy));
        // 1/(0.01 − 0.0025) paths of one step; with two steps 2/(0.01 − 0.000625) would be more.
        let coarse = at(0.1).expect("reached");
        assert_eq!(coarse.steps, 1);
        assert_relative_eq!(coarse.cost_s * 0.0075, 1.0, epsilon = 0.0, max_relative = 1e-12);
        // Its bias is known to be out of reach for the coarsest, and expensive for the next.
        assert_eq!(at(10f64.powf(-1.5)).map(|cost| cost.steps), Some(4));
        assert!(at(0.01).is_none() && at(1.0).is_none() && at(10f64.powf(-0.5)).is_some());
    }
}
