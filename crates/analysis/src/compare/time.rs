//! Processor time of a path: increments drawn and clipped, areas where a scheme reads them, steps.

use std::{hint::black_box, sync::Arc};

use mc::{Ladder, LadderError, Problem, Run, View, parts::Stop};
use noise::{StreamKey, Truncation};
use rayon::ThreadPoolBuilder;
use schemes::Method;

use crate::{FinalMoments, Spread, Stopwatch};

/// Paths that advance together on a ladder and share the damping of a step.
pub const PATHS: u64 = 128;
/// Steps that a repetition takes at least, over all its paths.
pub const PATH_STEPS: u64 = 1 << 14;

/// The processor time of a path of every scheme at its numbers of steps on [0, T], fewest first, in
/// seconds on one thread; those of few steps alone where `stop` ends it before.
///
/// Every repetition times every scheme at each of its numbers of steps once, so that a disturbance
/// hits all of them. In dimensions whose steps need a thread with a larger stack
/// ([`Ladder::runs_on_pool`]) times are wall times.
pub fn path_times<'a>(
    schemes: &[Arc<dyn Method + 'a>],
    problem: &Problem<'a>,
    steps: &[Vec<u64>],
    (truncation, key): (Truncation, StreamKey),
    repetitions: usize,
    stop: &Stop,
) -> Result<Vec<Vec<Spread>>, LadderError> {
    let mut ladders = Vec::new();
    for (s, (scheme, steps)) in schemes.iter().zip(steps).enumerate() {
        for &steps in steps {
            let runs = vec![Run::new(Arc::clone(scheme), 0)];
            let ladder = Ladder::new(problem, steps, 0, truncation, key, runs)?;
            ladders.push((steps, s, ladder));
        }
    }
    ladders.sort_by_key(|&(steps, ..)| steps);
    let mut measured = vec![Vec::with_capacity(repetitions); ladders.len()];
    let nothing = |_: &View<'_>, _: &mut [_]| ();
    // The clock of the thread is read on the thread that works.
    let one = ThreadPoolBuilder::new().num_threads(1).build();
    let one = one.unwrap_or_else(|error| panic!("cannot start a thread: {error}"));
    one.install(|| {
        for _ in 0..repetitions {
            for ((steps, _, ladder), seconds) in ladders.iter().zip(&mut measured) {
                let paths = PATH_STEPS.div_ceil(PATHS * steps).max(1) * PATHS;
                let watch = Stopwatch::start();
                let new = || FinalMoments::new(ladder.coarse_steps(), 0, &nothing);
                black_box(ladder.run_until(stop, 0, paths, new, &|_| ()));
                if stop.is_asked() {
                    return;
                }
                let time = if ladder.runs_on_pool() { watch.thread_s() } else { watch.wall_s() };
                seconds.push(time / paths as f64);
            }
        }
    });
    let mut times = vec![Vec::new(); steps.len()];
    for ((_, s, _), seconds) in ladders.into_iter().zip(measured).filter(|(_, s)| !s.is_empty()) {
        times[s].push(Spread::of(seconds));
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
        let noise = (Truncation::new(4)?, StreamKey { seed: 3, experiment: 1 });
        let schemes = [mc::bind(&problem, &Sexp), mc::bind(&problem, &Heun)];
        let (problem, stop) = (mc::Problem::of(&problem), Stop::default());
        let watch = Stopwatch::start();
        let times = path_times(&schemes, &problem, &[vec![8, 16], vec![256]], noise, 3, &stop)?;
        // Three repetitions of so many paths took no longer than all of it.
        assert_eq!(times.iter().map(Vec::len).collect::<Vec<_>>(), [2, 1]);
        let times = || times.iter().flatten();
        let shortest: f64 =
            times().zip([2048.0, 1024.0, 128.0]).map(|(time, n)| 3.0 * n * time.best).sum();
        assert!(shortest <= watch.wall_s(), "{shortest}");
        for time in times() {
            assert!(0.0 <= time.best && time.best <= time.median, "{time:?}");
            assert!(time.median <= time.worst, "{time:?}");
        }
        Ok(())
    }
}
