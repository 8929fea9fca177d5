//! The contract of `work-precision.json`; documented for other languages in
//! `docs/work-precision.md`.

use serde::{Deserialize, Serialize};
pub use verify::results::Provenance;

/// Raised whenever a reader of an older version would misread a newer one.
pub const SCHEMA: u32 = 1;

/// Everything measured.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Measurements {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Where it comes from.
    pub provenance: Provenance,
    /// What the times are, in words.
    pub clock: String,
    /// The cases.
    pub cases: Vec<Case>,
}

/// One problem.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Case {
    /// Identifier, for example `rigid-body-3`.
    pub id: String,
    /// What it is called on a figure.
    pub title: String,
    /// Parameters in words.
    pub setup: String,
    /// The invariants whose conformal defect is measured, in the order of the system; none where it
    /// has none.
    pub invariants: Vec<String>,
    /// Strong errors.
    pub strong: Strong,
    /// Weak errors.
    pub weak: Weak,
}

/// Processor time of one path, in seconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Time {
    /// Smallest of the repetitions: what the others have beyond it are disturbances. This is what
    /// curves show.
    pub min_s: f64,
    /// Median of the repetitions; its distance from the smallest is the spread.
    pub median_s: f64,
    /// Largest of the repetitions.
    pub max_s: f64,
    /// Number of repetitions.
    pub repetitions: usize,
    /// Paths in a repetition.
    pub paths: u64,
}

/// Strong errors of a case.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Strong {
    /// Paths behind every error.
    pub samples: u64,
    /// Paths that were left out because some scheme at some step size had no solution or was not
    /// finite.
    pub failed: u64,
    /// The first few of them.
    pub failures: Vec<String>,
    /// What errors are measured against.
    pub reference: String,
    /// One curve for each scheme.
    pub series: Vec<StrongSeries>,
}

/// The strong errors of one scheme.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StrongSeries {
    /// `sexp`, `sexp-levy`, `midpoint`, `heun` or `em`.
    pub scheme: String,
    /// Coarsest step first.
    pub points: Vec<StrongPoint>,
}

/// One scheme at one step size.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StrongPoint {
    /// Steps of a path.
    pub steps: u64,
    /// Step size.
    pub tau: f64,
    /// (E|y_N − y(T)|²)^½.
    pub error: f64,
    /// Its standard error.
    pub se: f64,
    /// Lower end of its bootstrap-t interval of 95 %.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lo: Option<f64>,
    /// Upper end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hi: Option<f64>,
    /// Of a scheme with Lévy areas: the error with exact areas of the step. `error` includes what
    /// the approximation of areas at the step itself may add.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_exact_areas: Option<f64>,
    /// Of a scheme with Lévy areas: terms of the series behind an area.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub area_terms: Option<usize>,
    /// For each of the case's invariants, (E|F(y_N)/(e^{−p∫γ}F(y₀)) − 1|²)^½: its relative distance
    /// from the conformal law.
    pub defects: Vec<f64>,
    /// Time of one path.
    pub time: Time,
}

/// Weak errors of a case.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Weak {
    /// Paths behind every bias.
    pub samples: u64,
    /// Paths that were left out.
    pub failed: u64,
    /// The first few of them.
    pub failures: Vec<String>,
    /// What biases are measured against.
    pub reference: String,
    /// The test functions.
    pub observables: Vec<WeakObservable>,
}

/// Weak errors for one test function.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct WeakObservable {
    /// For example `y1` or `cos y3`.
    pub name: String,
    /// E φ(y(T)) without sampling, where it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exact: Option<f64>,
    /// The reference's E φ(y(T)).
    pub reference_mean: f64,
    /// Its standard error.
    pub reference_se: f64,
    /// One curve for each scheme.
    pub series: Vec<WeakSeries>,
}

/// The weak errors of one scheme.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct WeakSeries {
    /// `sexp`, `sexp-levy`, `midpoint`, `heun` or `em`.
    pub scheme: String,
    /// Coarsest step first.
    pub points: Vec<WeakPoint>,
    /// What estimates of several accuracies cost, the least accurate first.
    pub costs: Vec<Cost>,
}

/// One scheme at one step size.
#[derive(Clone, Debug, Serialize, Deserialize)]
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
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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
