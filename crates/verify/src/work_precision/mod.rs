//! **Errors against the processor time that they cost**, for any schemes on any problem.
//!
//! [`work_precision`] measures strong errors at several step sizes against a reference on the same
//! noise, then the processor time of a path at each step size on one thread. Errors are the same
//! bits on any machine; times are those of the block kernels with their noise. [`cost_at`] and
//! [`crossing`] read the curves.
//!
//! ```
//! use noise::{StreamKey, Truncation};
//! use schemes::{EulerMaruyama, Heun, Sexp};
//! use systems::{Constant, Pendulum, Problem};
//! use verify::StepSizes;
//! use verify::work_precision::{Repetitions, cost_at, work_precision};
//!
//! let problem = Problem::new(Pendulum::new(1.0)?, Constant::new(2.0)?, [0.2, 1.0], 1.0)?;
//! // 16, 32, 64 and 128 steps; the reference takes 512.
//! let sizes = StepSizes {
//!     coarsest_steps: 16,
//!     levels: 4,
//!     refinement: 2,
//!     samples: 256,
//!     truncation: Truncation::new(4)?,
//!     key: StreamKey { seed: 1, experiment: 1 },
//! };
//! let repetitions = Repetitions { count: 3, path_steps: 1 << 12 };
//! let measured =
//!     work_precision(&[&Heun, &EulerMaruyama], &problem, &Sexp, &sizes, repetitions)?;
//! let [heun, em] = [0, 1].map(|n| measured.curves[n].costs());
//! // Heun is of order one here, Euler–Maruyama of order ½: seconds of a path at an error.
//! let finest = heun[3].0;
//! assert!(cost_at(&heun, finest).is_some() && cost_at(&em, finest).is_none());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | item | job |
//! |---|---|
//! | [`work_precision`], [`WorkPrecision`], [`WorkCurve`], [`WorkPoint`] | errors and times of a list of schemes |
//! | [`cost_at`], [`crossing`] | what an error costs between the points; where two curves cross |
//! | [`ladder`], [`path_times`], [`Repetitions`], [`Time`] | its parts, for other errors and other step sizes |

mod compare;
mod time;

use mc::{Ladder, LadderError, PathFailure, Run, View};
use schemes::Scheme;
use serde::{Deserialize, Serialize};
use stats::{CrossMoments, root_mean_square_interval};
use systems::{Damping, PoissonSystem, Problem};

pub use compare::{Crossing, cost_at, crossing};
pub use mc::squared_distance;
pub use time::{Repetitions, Time, path_times};

use crate::{FinalMoments, StepSizes};

/// Strong errors and times of several schemes.
#[derive(Clone, Debug)]
pub struct WorkPrecision {
    /// A curve for each scheme.
    pub curves: Vec<WorkCurve>,
    /// Paths that are left out of every error, because some scheme had no solution at some step.
    pub failed: u64,
    /// The first few of them.
    pub failures: Vec<PathFailure>,
}

/// Errors and times of one scheme.
#[derive(Clone, Debug)]
pub struct WorkCurve {
    /// Its identifier.
    pub scheme: &'static str,
    /// A point for each step size, coarsest first.
    pub points: Vec<WorkPoint>,
}

/// One scheme at one step size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WorkPoint {
    /// Steps of a path.
    pub steps: u64,
    /// Step size.
    pub tau: f64,
    /// (E|y_N − y(T)|²)^½.
    pub error: f64,
    /// Its standard error.
    pub se: f64,
    /// Lower end of its bootstrap-t interval of 95 %; none with fewer than 32 paths.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lo: Option<f64>,
    /// Upper end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hi: Option<f64>,
    /// Time of one path.
    pub time: Time,
}

impl WorkPoint {
    /// The point of τ = `t_end`/`steps` whose squared errors are component `index` of `squares`.
    pub fn new(t_end: f64, steps: u64, squares: &CrossMoments, index: usize, time: Time) -> Self {
        let error = squares.mean(index).sqrt();
        let se = squares.covariance_of_means(index, index).sqrt() / (2.0 * error);
        let (lo, hi) = root_mean_square_interval(squares, index).unzip();
        Self { steps, tau: t_end / steps as f64, error, se, lo, hi, time }
    }
}

impl WorkCurve {
    /// (error, seconds of a path), coarsest step first.
    pub fn costs(&self) -> Vec<(f64, f64)> {
        self.points.iter().map(|point| (point.error, point.time.min_s)).collect()
    }
}

/// A ladder on which every scheme runs at every step size of `sizes`, beside runs of references at
/// the finest levels.
///
/// The references are the first runs; run `references.len() + s·sizes.levels + l` is scheme s at
/// step size l, coarsest first.
///
/// # Errors
/// [`LadderError`] when there is no step size or no step, when there are too many of either, or
/// when the truncation is not defined at a step size.
pub fn ladder<'a, S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    schemes: &[&'a dyn Scheme<S, D, M>],
    problem: &'a Problem<S, G, D>,
    references: Vec<Run<'a, S, D, M>>,
    sizes: &StepSizes,
) -> Result<Ladder<'a, D, M>, LadderError> {
    sizes.check()?;
    let top = sizes.level(0);
    let mut runs = references;
    for &scheme in schemes {
        runs.extend((0..sizes.levels).map(|index| Run::new(scheme, sizes.level(index))));
    }
    Ladder::new(problem, sizes.reference_steps(), top, sizes.truncation, sizes.key, runs)
}

/// Strong errors at the final time and processor times of `schemes` at every step size of `sizes`.
///
/// Errors are root-mean-square distances to `reference` with T/(`coarsest_steps`·2^(`levels` − 1 +
/// `refinement`)) steps on the same noise. Its own error enters every other: take one of strong
/// order one, [`Sexp`](schemes::Sexp) with one noise or
/// [`SexpLevy`](schemes::SexpLevy) with several, and some refinement.
///
/// # Errors
/// [`LadderError`] as of [`ladder`].
///
/// # Panics
/// As [`path_times`].
pub fn work_precision<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    schemes: &[&dyn Scheme<S, D, M>],
    problem: &Problem<S, G, D>,
    reference: &dyn Scheme<S, D, M>,
    sizes: &StepSizes,
    repetitions: Repetitions,
) -> Result<WorkPrecision, LadderError> {
    let ladder = ladder(schemes, problem, vec![Run::new(reference, 0)], sizes)?;
    let squares = |view: &View<'_, D>, p: usize, squares: &mut [f64]| {
        let reference = view.states[0].path(p);
        for (square, state) in squares.iter_mut().zip(&view.states[1..]) {
            *square = squared_distance(state.path(p), reference);
        }
    };
    let length = schemes.len() * sizes.levels;
    let new = || FinalMoments::new(ladder.coarse_steps(), length, &squares);
    let outcome = ladder.run(sizes.samples, new, &|_| ());
    let steps: Vec<u64> = sizes.steps().collect();
    let StepSizes { truncation, key, .. } = *sizes;
    let times = path_times(schemes, problem, &steps, truncation, key, repetitions, &|_| ())?;
    let squares = &outcome.statistic.moments;
    let point = |s: usize, l: usize| {
        WorkPoint::new(problem.t_end(), steps[l], squares, s * sizes.levels + l, times[s][l])
    };
    let curves = schemes.iter().enumerate().map(|(s, scheme)| WorkCurve {
        scheme: scheme.id(),
        points: (0..sizes.levels).map(|l| point(s, l)).collect(),
    });
    Ok(WorkPrecision {
        curves: curves.collect(),
        failed: outcome.failed,
        failures: outcome.failures,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_has_the_error_of_its_index_and_a_curve_its_cheapest_times() {
        let mut squares = CrossMoments::new(2);
        (0..64).for_each(|n| squares.add(&[9.0, 4.0 + if n % 2 == 0 { 1.0 } else { -1.0 }]));
        let time =
            Time { min_s: 0.5, median_s: 1.0, max_s: 2.0, repetitions: 3, paths: 128, failed: 0 };
        let point = WorkPoint::new(3.0, 12, &squares, 1, time);
        assert_eq!((point.steps, point.tau, point.error), (12, 0.25, 2.0));
        // The mean 4 has the standard error √(1/63), and its root a quarter of that.
        assert!((point.se * 4.0 * 63f64.sqrt() - 1.0).abs() < 1e-12, "{}", point.se);
        assert!(point.lo.unwrap() < 2.0 && point.hi.unwrap() > 2.0);
        let other = WorkPoint::new(3.0, 24, &squares, 0, Time { min_s: 0.75, ..time });
        let curve = WorkCurve { scheme: "sexp", points: vec![point, other] };
        assert_eq!(curve.costs(), [(2.0, 0.5), (3.0, 0.75)]);
    }
}
