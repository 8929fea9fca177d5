//! Processor time of a path: increments drawn and clipped, areas where a scheme reads them, steps.

use std::fmt;
use std::hint::black_box;

use mc::{Ladder, LadderError, Run, Statistic, View};
use noise::{StreamKey, Truncation};
use rayon::{ThreadPoolBuildError, ThreadPoolBuilder};
use schemes::Scheme;
use serde::{Deserialize, Serialize};
use systems::{Damping, PoissonSystem, Problem};

use crate::{Spread, Stopwatch};

/// Paths that advance together on a ladder and share the damping of a step.
const PATHS: u64 = 128;

/// How often a time is measured.
#[derive(Clone, Copy, Debug)]
pub struct Repetitions {
    /// Repetitions of every time.
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
    #[must_use]
    pub fn work(self, schemes: usize, steps: &[u64]) -> u64 {
        let each: u64 = steps.iter().map(|&steps| self.paths(steps) * steps).sum();
        each * (schemes * self.count) as u64
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

/// Why no time was measured.
#[derive(Debug)]
#[non_exhaustive]
pub enum TimeError {
    /// The steps or the truncation were refused.
    Ladder(LadderError),
    /// No repetition was asked for.
    NoRepetition,
    /// The thread that is timed cannot be started.
    Thread(ThreadPoolBuildError),
}

impl fmt::Display for TimeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ladder(error) => error.fmt(f),
            Self::NoRepetition => f.write_str("a time needs at least one repetition, got 0"),
            Self::Thread(error) => write!(f, "cannot start a thread: {error}"),
        }
    }
}

impl std::error::Error for TimeError {}

impl From<LadderError> for TimeError {
    fn from(error: LadderError) -> Self {
        Self::Ladder(error)
    }
}

/// Keeps the final states from being optimised away, and nothing else.
struct Ignored {
    last_time: u64,
}

impl<const D: usize> Statistic<D> for Ignored {
    fn observe(&mut self, view: &View<'_, D>) {
        if view.time == self.last_time {
            black_box(view.states);
        }
    }

    fn merge(&mut self, _later: Self) {}
}

/// The processor time of a path of every scheme at every number of steps on [0, T], on one thread:
/// `times[s][l]` is that of scheme s with `steps[l]` steps.
///
/// Every repetition times every scheme at every number of steps once, so that a disturbance hits
/// all of them. In dimensions whose steps need a thread with a larger stack
/// ([`Ladder::runs_on_pool`]) times are wall times. `progress` is told how many more steps over all
/// paths are done.
///
/// # Errors
/// [`TimeError`].
pub fn path_times<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    schemes: &[&dyn Scheme<S, D, M>],
    problem: &Problem<S, G, D>,
    steps: &[u64],
    truncation: Truncation,
    key: StreamKey,
    repetitions: Repetitions,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Vec<Vec<Time>>, TimeError> {
    if repetitions.count == 0 {
        return Err(TimeError::NoRepetition);
    }
    let mut ladders = Vec::new();
    for &scheme in schemes {
        for &steps in steps {
            let runs = vec![Run::new(scheme, 0)];
            let ladder = Ladder::new(problem, steps, 0, truncation, key, runs)?;
            ladders.push((ladder, steps));
        }
    }
    let mut measured = vec![(Vec::with_capacity(repetitions.count), 0); ladders.len()];
    // The clock of the thread is read on the thread that works.
    let one = ThreadPoolBuilder::new().num_threads(1).build().map_err(TimeError::Thread)?;
    one.install(|| {
        for _ in 0..repetitions.count {
            for (&(ref ladder, steps), (seconds, failed)) in ladders.iter().zip(&mut measured) {
                let paths = repetitions.paths(steps);
                let new = || Ignored { last_time: steps };
                let watch = Stopwatch::start();
                *failed = ladder.run(paths, new, &|_| ()).failed;
                let time = if ladder.runs_on_pool() { watch.thread_s() } else { watch.wall_s() };
                seconds.push(time / paths as f64);
                progress(paths * steps);
            }
        }
    });
    let times: Vec<Time> = ladders
        .iter()
        .zip(measured)
        .map(|(&(_, steps), (seconds, failed))| {
            let Spread { best: min_s, median: median_s, worst: max_s } = Spread::of(seconds);
            let (paths, repetitions) = (repetitions.paths(steps), repetitions.count);
            Time { min_s, median_s, max_s, repetitions, paths, failed }
        })
        .collect();
    Ok(times.chunks(steps.len().max(1)).map(<[Time]>::to_vec).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use schemes::{Heun, Sexp};
    use systems::{Constant, Pendulum};

    #[test]
    fn times_are_ordered_and_count_their_paths() -> Result<(), Box<dyn std::error::Error>> {
        let problem = Problem::new(Pendulum::new(1.0)?, Constant::new(2.0)?, [0.2, 1.0], 1.0)?;
        let (sexp, truncation) = (Sexp::default(), Truncation::new(4)?);
        let key = StreamKey { seed: 3, experiment: 1 };
        let repetitions = Repetitions { count: 3, path_steps: 1 };
        let measure = |repetitions| {
            path_times(&[&sexp, &Heun], &problem, &[8, 16], truncation, key, repetitions, &|_| ())
        };
        let times = measure(repetitions)?;
        assert_eq!((times.len(), times[0].len(), repetitions.work(2, &[8, 16])), (2, 2, 18_432));
        for time in times.iter().flatten() {
            assert!(0.0 <= time.min_s && time.min_s <= time.median_s, "{time:?}");
            assert!(time.median_s <= time.max_s, "{time:?}");
            assert_eq!((time.repetitions, time.paths, time.failed), (3, PATHS, 0));
        }
        assert!(measure(Repetitions { count: 0, path_steps: 1 }).is_err());
        Ok(())
    }
}
