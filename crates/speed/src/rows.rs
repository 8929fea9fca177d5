//! Every scheme on every system, on one thread.

use std::hint::black_box;

use lab::Compiled;
use mc::{Ladder, Run};
use noise::{StreamKey, Truncation};
use rayon::{ThreadPool, ThreadPoolBuilder};
use systems::{Damping, PoissonSystem, Problem};

use crate::last::LastMean;
use crate::stopwatch::{Times, repeat};
use crate::systems_list::{Visit, schemes_for, visit_systems};
use crate::workload::TAU;
use crate::{SchemeRow, SpeedError, Workload};

/// Truncation order and streams of all measurements.
const TRUNCATION_ORDER: u32 = 4;
const KEY: StreamKey = StreamKey { seed: 1, experiment: 0 };

/// A pool of so many threads.
pub(crate) fn pool(threads: usize) -> Result<ThreadPool, SpeedError> {
    Ok(ThreadPoolBuilder::new().num_threads(threads).build()?)
}

/// Steps of size τ on a ladder with `levels` levels above the finest.
pub(crate) fn ladder<'a, S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    problem: &'a Problem<S, G, D>,
    steps: u64,
    levels: usize,
    runs: Vec<Run<'a, S, D, M>>,
) -> Result<Ladder<'a, S, G, D, M>, SpeedError> {
    let truncation = Truncation::new(TRUNCATION_ORDER).map_err(mc::LadderError::from)?;
    Ok(Ladder::new(problem, steps, levels, truncation, KEY, runs)?)
}

/// Runs the ladder on the current pool; returns how many paths were left out.
pub(crate) fn run_once<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    ladder: &Ladder<'_, S, G, D, M>,
    paths: u64,
) -> u64 {
    let coarse_steps = ladder.coarse_steps();
    let outcome = black_box(ladder.run(paths, || LastMean::new(coarse_steps), &|_| ()));
    // A mean that is no number would be a measurement of something else.
    if outcome.statistic.is_finite() { outcome.failed } else { paths }
}

/// Repeats the ladder on one thread; with how many paths were left out.
pub(crate) fn time_on_one_thread<
    S: PoissonSystem<D, M>,
    G: Damping,
    const D: usize,
    const M: usize,
>(
    one: &ThreadPool,
    ladder: &Ladder<'_, S, G, D, M>,
    paths: u64,
    repetitions: u32,
) -> (Times, u64) {
    // The clock of the thread is read on the thread that works.
    one.install(|| {
        let mut failed = 0;
        let times = repeat(repetitions, || failed = run_once(ladder, paths));
        (times, failed)
    })
}

pub(crate) fn rows(
    workload: &Workload,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Vec<SchemeRow>, SpeedError> {
    let mut measure = Measure { workload, progress, one: pool(1)?, rows: Vec::new() };
    visit_systems(&mut measure)?;
    Ok(measure.rows)
}

struct Measure<'a> {
    workload: &'a Workload,
    progress: &'a (dyn Fn(&str) + Sync),
    one: ThreadPool,
    rows: Vec<SchemeRow>,
}

impl Visit for Measure<'_> {
    type Error = SpeedError;

    fn visit<S: Compiled<D, M>, G: Damping, const D: usize, const M: usize>(
        &mut self,
        name: &str,
        system: S,
        damping: G,
        y0: [f64; D],
    ) -> Result<(), SpeedError> {
        let Workload { paths, steps, repetitions } = *self.workload;
        let schemes = schemes_for(&system, y0);
        let problem = Problem::new(system, damping, y0, self.workload.t_end())?;
        assert!((problem.t_end / steps as f64 - TAU).abs() < f64::EPSILON);
        let ns = 1e9 / (paths * steps) as f64;
        for scheme in &schemes {
            (self.progress)(&format!("{} on {name}", scheme.id()));
            let ladder = ladder(&problem, steps, 0, vec![Run::new(scheme.as_ref(), 0)])?;
            let (times, failed) = time_on_one_thread(&self.one, &ladder, paths, repetitions);
            self.rows.push(SchemeRow {
                system: name.to_owned(),
                dimension: D,
                noises: M,
                scheme: scheme.id().to_owned(),
                ns_per_path_step: times.thread.scaled(ns),
                wall_ns_per_path_step: times.wall.scaled(ns),
                failed,
            });
        }
        Ok(())
    }
}
