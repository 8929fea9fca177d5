//! How often the intervals cover the truth, measured on data whose law is known.
//!
//! Every data set is drawn from a law with a known order, mean-square error or weak error; an
//! interval is computed as for any experiment, and it is counted whether the truth lies inside.
//! With R data sets the count has the standard error √(0.95·0.05/R): ±0.49 % for 2000. Warnings are
//! counted likewise: where a few paths carry an error, or a model does not fit, they have to be
//! raised, elsewhere not. Beside the intervals in use stand twins that forget something (the
//! covariance between levels, the reference, heavy tails) and have to miscover, or the measurement
//! could not tell.

mod data;
mod motion;
mod synthetic;

use noise::StreamKey;
use rayon::prelude::*;
use stats::Point;

/// How often one kind of interval covered the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoverageRow {
    /// The data.
    pub case: &'static str,
    /// The interval, with what it is an interval for; or the warning.
    pub interval: &'static str,
    /// Its nominal coverage, 0.95; of a warning, 1 or 0.
    pub nominal: f64,
    /// Data sets whose interval contains the truth, or that are warned about; one without an
    /// interval does not count.
    pub covered: u64,
    /// Data sets.
    pub replications: u64,
    /// What it has to do.
    pub expected: Expected,
}

/// What a kind of interval, or a warning, has to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expected {
    /// Cover as often as it says, within two percent.
    Calibrated,
    /// Not cover as often as it says: a twin that forgets something.
    Miscovers,
    /// A warning, to be raised on nearly every data set; `covered` counts how often it is.
    Raised,
    /// A warning, to be raised on nearly none.
    Silent,
    /// Nothing: the figure is stated for comparison. Either the interval is not in use, or what
    /// spoils it is absent from most data sets, so that neither an interval nor a warning can know
    /// of it.
    Stated,
}

impl Expected {
    /// The share to be expected.
    fn nominal(self) -> f64 {
        match self {
            Self::Raised => 1.0,
            Self::Silent => 0.0,
            Self::Calibrated | Self::Miscovers | Self::Stated => 0.95,
        }
    }
}

impl CoverageRow {
    /// Share of the data sets whose interval contains the truth.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.covered as f64 / self.replications as f64
    }

    /// Whether the interval does what is expected, with `tolerance` as the largest deviation from
    /// the nominal coverage.
    #[must_use]
    pub fn as_expected(&self, tolerance: f64) -> bool {
        let deviation = (self.share() - self.nominal).abs();
        match self.expected {
            Expected::Calibrated | Expected::Raised | Expected::Silent => deviation <= tolerance,
            Expected::Miscovers => deviation > tolerance,
            Expected::Stated => true,
        }
    }
}

/// Measures the coverage of every kind of interval on `replications` data sets each, on the current
/// rayon pool.
///
/// The rows are functions of the arguments alone.
#[must_use]
pub fn coverage(replications: u64, seed: u64) -> Vec<CoverageRow> {
    let mut rows = Vec::new();
    synthetic::rows(&mut Tally { rows: &mut rows, replications, seed, case: 0 });
    motion::rows(&mut Tally { rows: &mut rows, replications, seed, case: MOTION });
    rows
}

/// Number of the first case of geometric Brownian motion, so that no two cases share noise.
const MOTION: u64 = 100;
/// Quantile of the intervals value ± 1.96 se.
const Z: f64 = 1.959_963_984_540_054;

/// Counts, case by case.
struct Tally<'a> {
    rows: &'a mut Vec<CoverageRow>,
    replications: u64,
    seed: u64,
    case: u64,
}

impl Tally<'_> {
    /// One case: `covered` says of each data set which of the intervals contain the truth.
    fn add<const N: usize>(
        &mut self,
        case: &'static str,
        intervals: [(&'static str, Expected); N],
        covered: impl Fn(StreamKey) -> [bool; N] + Sync,
    ) {
        self.case += 1;
        let first = self.case << 40;
        let counts = (0..self.replications)
            .into_par_iter()
            .map(|replication| {
                covered(StreamKey { seed: self.seed, experiment: first + replication })
                    .map(u64::from)
            })
            .reduce(|| [0; N], |a, b| std::array::from_fn(|i| a[i] + b[i]));
        self.rows.extend(intervals.into_iter().zip(counts).map(
            |((interval, expected), covered)| CoverageRow {
                case,
                interval,
                nominal: expected.nominal(),
                covered,
                replications: self.replications,
                expected,
            },
        ));
    }
}

/// Whether the ends, if there are any, enclose the truth.
fn encloses(ends: Option<(f64, f64)>, truth: f64) -> bool {
    ends.is_some_and(|(lo, hi)| lo <= truth && truth <= hi)
}

/// Whether the interval of a point encloses the truth at its step size.
fn point_encloses(point: &Point, truth: impl Fn(f64) -> f64) -> bool {
    match *point {
        Point::Error { tau, lo, hi, .. } if lo.is_some() => encloses(lo.zip(hi), truth(tau)),
        _ => bar_encloses(point, truth),
    }
}

/// Whether there is a warning at the point.
fn point_warns(point: &Point) -> bool {
    matches!(point, Point::Error { warning: Some(_), .. })
}

/// Whether value ± 1.96 se of a point encloses the truth at its step size.
fn bar_encloses(point: &Point, truth: impl Fn(f64) -> f64) -> bool {
    match *point {
        Point::Error { tau, value, se, .. } => (value - truth(tau)).abs() <= Z * se,
        Point::Value { .. } | Point::Cost { .. } => false,
    }
}
