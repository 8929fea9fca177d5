//! Processor time of a path: increments drawn and clipped, areas where a scheme reads them, steps.

use std::{hint::black_box, sync::Arc};

use mc::{Ladder, LadderError, Problem, Run, View, parts::Stop};
use noise::{StreamKey, Truncation};
use rayon::ThreadPoolBuilder;
use schemes::Method;
use serde::{Deserialize, Serialize};

use crate::{FinalMoments, Spread, Stopwatch};

/// Paths that advance together on a ladder and share the damping of a step.
const PATHS: u64 = 128;

/// How often a time is measured.
#[derive(Clone, Copy, Debug)]
pub struct Repetitions {
    /// Repetitions of every time, one at least.
    pub count: usize,
    /// Steps that a repetition takes at least, over all its paths.
    pub path_steps: u64,
}

impl Repetitions {
    /// Paths of a repetition.
    fn paths(self, steps: u64) -> u64 {
        self.path_steps.div_ceil(PATHS * steps).max(1) * PATHS
    }

    /// Steps over all paths and repetitions that [`path_times`] takes.
    pub fn work(self, steps: &[Vec<u64>]) -> u64 {
        let each: u64 = steps.iter().flatten().map(|&steps| self.paths(steps) * steps).sum();
        each * self.count as u64
    }
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
    /// Those of them without a solution.
    #[serde(default)]
    pub failed: u64,
}

/// The processor time of a path of every scheme at its numbers of steps on [0, T], on one thread:
/// `times[s]` are those of scheme s with `steps[s]` steps, each with its number of steps.
///
/// Every repetition times every scheme at each of its numbers of steps once, so that a disturbance
/// hits all of them. In dimensions whose steps need a thread with a larger stack
/// ([`Ladder::runs_on_pool`]) times are wall times. `progress` is told how many more steps over all
/// paths are done.
///
/// # Errors
/// [`LadderError`] when the steps or the truncation are refused.
///
/// # Panics
/// When no repetition is asked for, or when no thread can be started.
pub fn path_times<'a>(
    schemes: &[Arc<dyn Method + 'a>],
    problem: &Problem<'a>,
    steps: &[Vec<u64>],
    truncation: Truncation,
    key: StreamKey,
    (repetitions, stop): (Repetitions, &Stop),
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Vec<Vec<(u64, Time)>>, LadderError> {
    assert!(repetitions.count > 0, "a time needs at least one repetition");
    let mut ladders = Vec::new();
    for (s, (scheme, steps)) in schemes.iter().zip(steps).enumerate() {
        for &steps in steps {
            let runs = vec![Run::new(Arc::clone(scheme), 0)];
            let ladder = Ladder::new(problem, steps, 0, truncation, key, runs)?;
            ladders.push((ladder, steps, s));
        }
    }
    ladders.sort_by_key(|&(_, steps, _)| steps);
    let nothing = |_: &View<'_>, _: usize, _: &mut [f64]| ();
    let mut measured = vec![(Vec::with_capacity(repetitions.count), 0); ladders.len()];
    // The clock of the thread is read on the thread that works.
    let one = ThreadPoolBuilder::new().num_threads(1).build();
    let one = one.unwrap_or_else(|error| panic!("cannot start a thread: {error}"));
    one.install(|| {
        for _ in 0..repetitions.count {
            for (&(ref ladder, steps, _), (seconds, failed)) in ladders.iter().zip(&mut measured) {
                let paths = repetitions.paths(steps);
                let watch = Stopwatch::start();
                let new = || FinalMoments::new(ladder.coarse_steps(), 0, &nothing);
                let run = black_box(ladder.run_until(stop, 0, paths, new, &|_| ()));
                if stop.is_asked() {
                    return;
                }
                *failed = run.failed;
                let time = if ladder.runs_on_pool() { watch.thread_s() } else { watch.wall_s() };
                seconds.push(time / paths as f64);
                progress(paths * steps);
            }
        }
    });
    let mut times = vec![Vec::new(); steps.len()];
    for (&(_, steps, s), (seconds, failed)) in ladders.iter().zip(measured) {
        if !seconds.is_empty() {
            let (paths, repetitions) = (repetitions.paths(steps), seconds.len());
            let Spread { best: min_s, median: median_s, worst: max_s } = Spread::of(seconds);
            times[s].push((steps, Time { min_s, median_s, max_s, repetitions, paths, failed }));
        }
    }
    Ok(times)
}

#[cfg(test)]
mod tests {
    use super::*;
    use schemes::{Heun, Sexp};
    use systems::{Constant, Pendulum};

    #[test]
    fn times_are_ordered_and_count_their_paths() -> Result<(), Box<dyn std::error::Error>> {
        let problem =
            systems::Problem::new(Pendulum::new(1.0)?, Constant::new(2.0)?, [0.2, 1.0], 1.0)?;
        let (sexp, truncation) = (Sexp, Truncation::new(4)?);
        let key = StreamKey { seed: 3, experiment: 1 };
        let repetitions = Repetitions { count: 3, path_steps: 1 };
        let schemes = [mc::bind(&problem, &sexp), mc::bind(&problem, &Heun)];
        let (problem, stop) = (mc::Problem::of(&problem), Stop::default());
        let steps = [vec![8, 16], vec![16]];
        let watch = Stopwatch::start();
        let times =
            path_times(&schemes, &problem, &steps, truncation, key, (repetitions, &stop), &|_| ())?;
        // Three repetitions of 128 paths took no longer than all of it.
        let times = || times.iter().flatten();
        let shortest: f64 = times().map(|(_, time)| 3.0 * 128.0 * time.min_s).sum();
        assert!(shortest <= watch.wall_s(), "{shortest}");
        assert_eq!(times().map(|(steps, _)| *steps).collect::<Vec<_>>(), [8, 16, 16]);
        assert_eq!(repetitions.work(&steps), 3 * 128 * 40);
        for (_, time) in times() {
            assert!(0.0 <= time.min_s && time.min_s <= time.median_s, "{time:?}");
            assert!(time.median_s <= time.max_s, "{time:?}");
            assert_eq!((time.repetitions, time.paths, time.failed), (3, PATHS, 0));
        }
        Ok(())
    }
}
