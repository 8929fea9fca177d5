//! Weak errors against a reference on the same noise, and what expectations cost.

use mc::{LadderError, Observe, View};
use real::Row;
use serde::{Deserialize, Serialize};

use super::{
    cost::Curve,
    grid::{Grid, REFERENCES, Sampled, Series, Timed},
    time::Time,
};
use crate::orders::{difference, evaluate};

/// Weak errors of several schemes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Weak {
    /// Paths and reference.
    #[serde(flatten)]
    pub sampled: Sampled,
    /// The test functions.
    pub observables: Vec<WeakObservable>,
}

/// Weak errors for one test function.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
    /// A bound of its bias: how far it is from that of twice the step size, with 95 %.
    pub reference_error: f64,
    /// One curve for each scheme.
    pub series: Vec<Series<WeakPoint>>,
}

/// The weak error of one scheme at one step size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WeakPoint {
    /// Steps of a path.
    pub steps: u64,
    /// Step size.
    pub tau: f64,
    /// E φ(y_N) − E φ(y(T)), against the reference.
    pub bias: f64,
    /// Its standard error.
    pub se: f64,
    /// Lower end of the 95 % interval of |bias|, less the error of the reference.
    pub lo: f64,
    /// Upper end, with the error of the reference added.
    pub hi: f64,
    /// Standard deviation of φ(y_N).
    pub standard_deviation: f64,
    /// Processor time of one path, where it was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<Time>,
}

/// The cheapest plain Monte Carlo estimate of a given root-mean-square error among the measured
/// step sizes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// (bias² + variance/paths)^½, where the bias is taken at the upper end of its interval.
    pub accuracy: f64,
    /// Steps of a path.
    pub steps: u64,
    /// Paths: variance/(accuracy² − bias²), at least one.
    pub paths: f64,
    /// Its processor time in seconds: paths times the time of one.
    pub cost_s: f64,
}

/// Two-sided 95 % quantile of the normal distribution.
const QUANTILE: f64 = 1.96;
/// Accuracies 10^{−k/4} for k up to this are looked at.
const FINEST: i32 = 28;

impl WeakPoint {
    /// An estimate of this root-mean-square error if the size of the bias is `bias`; `None` if the
    /// bias alone is larger, or nothing was timed.
    fn cost(&self, accuracy: f64, bias: f64) -> Option<Cost> {
        let variance = self.standard_deviation * self.standard_deviation;
        let paths = f64::max(variance / (accuracy * accuracy - bias * bias), 1.0);
        let cost_s = paths * self.time?.min_s;
        (bias < accuracy).then_some(Cost { accuracy, steps: self.steps, paths, cost_s })
    }
}

impl Timed for WeakPoint {
    fn steps(&self) -> u64 {
        self.steps
    }
    fn set_time(&mut self, time: Time) {
        self.time = Some(time);
    }
}

impl Series<WeakPoint> {
    /// The cheapest estimate of this root-mean-square error over the step sizes.
    pub fn cost(&self, accuracy: f64) -> Option<Cost> {
        self.cheapest(|point| point.cost(accuracy, point.hi))
    }

    /// The same if biases were as small as their intervals allow.
    pub(super) fn least_cost(&self, accuracy: f64) -> Option<Cost> {
        self.cheapest(|point| point.cost(accuracy, point.lo))
    }

    fn cheapest(&self, cost: impl Fn(&WeakPoint) -> Option<Cost>) -> Option<Cost> {
        self.points.iter().filter_map(cost).min_by(|a, b| a.cost_s.total_cmp(&b.cost_s))
    }

    /// What estimates of the accuracies 10^{−k/4} cost, from half the standard deviation
    /// downwards, where a single path says next to nothing, to what the bias allows.
    pub fn costs(&self) -> Vec<Cost> {
        let spread = self.points.last().map_or(0.0, |point| point.standard_deviation);
        (0..=FINEST)
            .map(|k| 10f64.powf(-0.25 * f64::from(k)))
            .filter(|&accuracy| accuracy <= 0.5 * spread)
            .filter_map(|accuracy| self.cost(accuracy))
            .collect()
    }

    /// (accuracy, seconds of an estimate).
    pub fn curve(&self) -> Curve {
        let points = self.costs().into_iter().map(|cost| (cost.accuracy, cost.cost_s));
        Curve { scheme: self.scheme.clone(), points: points.collect() }
    }
}

impl Weak {
    /// Weak errors of `observables` at the final time, of all schemes of a grid. Nothing is timed.
    ///
    /// A bias is the mean difference to the reference on the same noise, extrapolated in the step
    /// size: 2φ(y_τ) − φ(y_{2τ}). The difference of that to the extrapolation at twice the step
    /// bounds its bias.
    ///
    /// # Errors
    /// As [`Strong::measure`](super::Strong::measure).
    pub fn measure(
        grid: &Grid<'_>,
        observables: &[&dyn Observe],
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Self, LadderError> {
        // The reference, its difference to that at twice the step, and for every point φ and its
        // difference to the reference.
        let each = 2 + 2 * grid.points();
        let values = |view: &View<'_>, values: &mut [Row]| {
            for (observable, values) in observables.iter().zip(values.chunks_exact_mut(each)) {
                let phi = |run: usize| evaluate(*observable, view.state(run), view.live);
                // An error Cτ + O(τ²) of the expectation is C·2τ + O(τ²) at twice the step.
                let extrapolated =
                    |run: usize| difference(&phi(run).map(|phi| 2.0 * phi), &phi(run + 1));
                values[0] = extrapolated(0);
                values[1] = difference(&values[0], &extrapolated(1));
                let reference = values[0];
                for (run, pair) in values[2..].chunks_exact_mut(2).enumerate() {
                    pair[0] = phi(REFERENCES + run);
                    pair[1] = difference(&pair[0], &reference);
                }
            }
        };
        let length = observables.len() * each;
        let (moments, mut sampled) = grid.moments(false, length, &values, progress)?;
        let [finest, next, _] = grid.reference_steps();
        sampled.reference +=
            &format!(" extrapolated from {next} and {finest} steps on the same noise");
        let se = |index: usize| moments.covariance_of_means(index, index).max(0.0).sqrt();
        let observables = observables.iter().enumerate().map(|(f, observable)| {
            let first = f * each;
            let reference_error = moments.mean(first + 1).abs() + QUANTILE * se(first + 1);
            let point = |number: usize, _: Option<usize>, steps: u64| {
                let value = first + 2 + 2 * number;
                let (bias, error) = (moments.mean(value + 1), se(value + 1));
                let half_width = QUANTILE * error + reference_error;
                WeakPoint {
                    steps,
                    tau: grid.problem.t_end / steps as f64,
                    bias,
                    se: error,
                    lo: (bias.abs() - half_width).max(0.0),
                    hi: bias.abs() + half_width,
                    standard_deviation: se(value) * (moments.count() as f64).sqrt(),
                    time: None,
                }
            };
            WeakObservable {
                name: observable.name().to_owned(),
                exact: None,
                reference_mean: moments.mean(first),
                reference_se: se(first),
                reference_error,
                series: grid.series(point),
            }
        });
        Ok(Self { observables: observables.collect(), sampled })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_estimate_takes_the_step_that_is_cheapest_for_it() {
        let time =
            |s| Some(Time { min_s: s, median_s: s, max_s: s, repetitions: 1, paths: 1, failed: 0 });
        let point = |steps: u64, bias: f64| WeakPoint {
            steps,
            tau: 1.0 / steps as f64,
            bias,
            se: 0.0,
            lo: 0.5 * bias.abs(),
            hi: bias.abs(),
            standard_deviation: 1.0,
            time: time(steps as f64),
        };
        let points = vec![point(1, -0.05), point(2, 0.025), point(4, 0.0125)];
        let series = Series { scheme: "a".to_owned(), points };
        let (found, close) = (series.costs(), |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12);
        let at = |accuracy: f64| found.iter().find(|cost| close(cost.accuracy, accuracy));
        // 1/(0.01 − 0.0025) paths of one step; with two steps 2/(0.01 − 0.000625) would be more.
        let coarse = at(0.1).expect("reached");
        assert_eq!(coarse.steps, 1);
        assert!(close(coarse.cost_s, 1.0 / 0.0075));
        // Its bias is known to be out of reach for the coarsest, and expensive for the next.
        assert_eq!(at(10f64.powf(-1.5)).map(|cost| cost.steps), Some(4));
        assert!(at(0.01).is_none() && at(1.0).is_none() && at(10f64.powf(-0.5)).is_some());
        // With half the bias two steps do, for 2/(0.001 − 0.0125²).
        let least = series.least_cost(10f64.powf(-1.5)).expect("reached");
        assert!(least.steps == 2 && close(least.cost_s, 2.0 / (0.001 - 0.000_156_25)), "{least:?}");
    }
}
