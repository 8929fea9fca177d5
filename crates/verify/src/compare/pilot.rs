//! A few paths of one scheme at several step sizes: where it runs, and how its error falls.

use std::sync::Arc;

use mc::{DynProblem, DynRun, Ladder, LadderError, View};
use noise::{StepNoise, StreamKey, Truncation};
use real::Row;

use super::candidates::Entrant;
use crate::{FinalMoments, Stopwatch, orders::squared_distance};

/// Paths of a pilot.
const PATHS: u64 = 64;
/// Step sizes at first, and at least.
const SIZES: [u32; 2] = [6, 4];
/// The finest pilot has 2^this times the base steps.
const FINEST: u32 = 16;
/// Errors that fall with less than this exponent of the step size are not those of a scheme yet.
const FALLS: f64 = 0.3;

/// What a pilot shows of a scheme. Step sizes are numbered by the base 2 logarithm of their steps
/// over the base steps.
pub struct Pilot {
    /// The coarsest step size at which no path fails.
    pub first: u32,
    /// Root-mean-square differences to the next step size, from the first on.
    differences: Vec<f64>,
    /// Seconds of a step of one path on one thread, noise included.
    pub seconds: f64,
    /// The first failure, if paths fail at all step sizes.
    pub failure: Option<String>,
}

impl Pilot {
    /// Runs the scheme at step sizes from T/`base` on until its errors fall, or are below `wanted`.
    /// It ends early when `spent` says so.
    pub fn new<N: StepNoise>(
        entrant: &Entrant<'_, N>,
        problem: &DynProblem<'_>,
        truncation: Truncation,
        key: StreamKey,
        base: u64,
        wanted: f64,
        spent: &dyn Fn() -> bool,
    ) -> Result<Self, LadderError> {
        let scheme = entrant.as_drawn();
        let (mut first, mut finest) = (0, SIZES[0] - 1);
        loop {
            let sizes = (finest - first + 1) as usize;
            let run = |level| DynRun::new(Arc::clone(scheme), level);
            let runs = (0..sizes).rev().map(run).collect();
            let steps = base << finest;
            let ladder = Ladder::of(problem, steps, sizes - 1, truncation, key, runs)?;
            let values = |view: &View<'_>, values: &mut [Row]| {
                for (run, value) in values.iter_mut().enumerate() {
                    *value = squared_distance(view.state(run), view.state(run + 1), view.live);
                }
            };
            let new = || FinalMoments::of_rows(ladder.coarse_steps(), sizes - 1, &values);
            let watch = Stopwatch::start();
            let measured = ladder.run(PATHS, new, &|_| ());
            let seconds = watch.wall_s() / (PATHS * ladder.steps_per_path()) as f64;
            let means = measured.statistic.moments.means();
            let failure = measured.failures.first().map(ToString::to_string);
            let differences = means.into_iter().map(f64::sqrt).collect();
            let pilot = Self { first, differences, seconds, failure };
            let last = finest >= FINEST || spent();
            if measured.failed == 0 && (last || pilot.falls() || pilot.finest_error() <= wanted) {
                return Ok(pilot);
            }
            let fails = measured.failed > 0;
            if fails && finest - first >= SIZES[1] {
                first += 1;
            } else if last {
                return Ok(pilot);
            } else {
                finest += 2;
                first += if fails { 2 } else { 0 };
            }
        }
    }

    /// log₂ of the ratio of the last two differences.
    fn exponent(&self) -> f64 {
        let [.., before, last] = self.differences[..] else { return 0.0 };
        (before / last).log2()
    }

    fn falls(&self) -> bool {
        self.exponent() >= FALLS
    }

    /// The error after the finest difference, at half the step: the difference itself. Of order one
    /// errors add up, and e(τ) − e(τ/2) is e(τ/2). Of order ½ the difference is uncorrelated with the
    /// error that is left, and the squares e(τ)² − e(τ/2)² are e(τ/2)².
    fn finest_error(&self) -> f64 {
        self.differences.last().copied().unwrap_or(0.0)
    }

    /// The step size half of which is expected to have the error `wanted`.
    pub fn predicted(&self, wanted: f64) -> u32 {
        let p = self.exponent().clamp(0.5, 1.0);
        let above = |difference: &&f64| **difference > wanted;
        let count = self.differences.len() as u32;
        match self.differences.iter().rev().take_while(|d| !above(d)).count() as u32 {
            0 => self.first + count - 1 + steps_beyond(self.finest_error(), wanted, p),
            below => self.first + count - below,
        }
    }
}

/// Halvings of the step size from one error to another one at order p.
pub fn steps_beyond(error: f64, wanted: f64, p: f64) -> u32 {
    ((error / wanted).log2() / p).ceil().clamp(0.0, 64.0) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_size_is_predicted_between_the_differences_and_beyond() {
        let pilot =
            |differences: Vec<f64>| Pilot { first: 2, differences, seconds: 1.0, failure: None };
        // Order one: the error is as large as the difference to the next.
        let one = pilot(vec![0.5, 0.25, 0.125]);
        assert_eq!([0.6, 0.5, 0.3, 0.125, 0.1, 0.01].map(|e| one.predicted(e)), [2, 2, 3, 4, 5, 8]);
        // Order ½: as large, too, at half the step; a hundredth of it needs 10⁴ ≈ 2^13.3 times the
        // steps.
        let half = pilot([0.0, 0.5, 1.0].map(|k| f64::exp2(-k)).to_vec());
        let error = half.finest_error();
        assert_eq!(error, 0.5);
        assert_eq!(half.predicted(0.01 * error), 4 + 14);
        // A difference that happens to be small in between does not count.
        assert_eq!(pilot(vec![0.5, 0.05, 0.25, 0.125]).predicted(0.1), 6);
    }
}
