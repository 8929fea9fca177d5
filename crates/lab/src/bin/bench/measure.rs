//! Every scheme on every system, and one of them with more threads, samples, steps and levels.

use std::fs;
use std::thread::available_parallelism;

use anyhow::{Context, Result};
use lab::compiled;
use lab::setups::{Setup, Visit, visit_others, visit_paper};
use mc::{Ladder, Run};
use noise::{StreamKey, Truncation};
use rayon::{ThreadPool, ThreadPoolBuilder};
use real::Level;
use report::provenance::peak_memory_mb;
use schemes::Sexp;
use systems::paper::rigid_body_three_noises;
use systems::{Damping, PoissonSystem, Problem};
use verify::{FinalMoments, Spread, Stopwatch};

use crate::results::{Clock, GrowthRow, SchemeRow, Speed, ThreadRow, Workload};

/// Streams of all measurements.
pub const KEY: StreamKey = StreamKey { seed: 1, experiment: 0 };
/// The step size of all measurements, 2⁻⁸.
const TAU: f64 = 1.0 / 256.0;

/// Measures everything; `progress` is told what comes next.
pub fn measure(workload: Workload, progress: &dyn Fn(&str)) -> Result<Speed> {
    let load_before = load();
    let one = pool(1)?;
    let growth = growth(workload, &one, progress)?;
    let mut rows = Rows { workload, progress, one, rows: Vec::new() };
    visit_paper(&mut rows)?;
    visit_others(&mut rows)?;
    Ok(Speed {
        workload,
        clock: if Stopwatch::MEASURES_PROCESSOR { Clock::OnCore } else { Clock::Wall },
        simd: Level::current().name(),
        optimised: !cfg!(debug_assertions),
        load_before,
        schemes: rows.rows,
        threads: threads(workload, progress)?,
        growth,
        peak_memory_mb: peak_memory_mb(),
    })
}

/// Processes that were running or waiting to, on average over the last minute, where the system
/// tells.
fn load() -> Option<f64> {
    fs::read_to_string("/proc/loadavg").ok()?.split_whitespace().next()?.parse().ok()
}

fn pool(threads: usize) -> Result<ThreadPool> {
    ThreadPoolBuilder::new().num_threads(threads).build().context("cannot start the threads")
}

/// A ladder of steps of size τ with `levels` levels above the finest.
fn ladder<'a, S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    problem: &'a Problem<S, G, D>,
    levels: usize,
    runs: Vec<Run<'a, S, D, M>>,
) -> Result<Ladder<'a, D, M>> {
    let steps = (problem.t_end / TAU).round() as u64;
    Ok(Ladder::new(problem, steps, levels, Truncation::new(4)?, KEY, runs)?)
}

/// Runs the ladder on the current pool with a small statistic, the mean of the final state; returns
/// how many paths were left out.
fn run_once<const D: usize, const M: usize>(ladder: &Ladder<'_, D, M>, paths: u64) -> u64 {
    let state = |states: &[[f64; D]], values: &mut [f64]| values.copy_from_slice(&states[0]);
    let new = || FinalMoments::new(ladder.coarse_steps(), D, &state);
    std::hint::black_box(ladder.run(paths, new, &|_| ())).failed
}

/// Wall and thread time of repetitions in seconds, and how many paths were left out.
struct Times {
    wall: Spread,
    thread: Spread,
    failed: u64,
}

/// Runs the ladder once to warm up and then `repetitions` times, on a pool. The time of the thread
/// is that of a single thread.
fn repeat<const D: usize, const M: usize>(
    pool: &ThreadPool,
    ladder: &Ladder<'_, D, M>,
    paths: u64,
    repetitions: u32,
) -> Times {
    // The clock of the thread is read on the thread that works.
    pool.install(|| {
        let failed = run_once(ladder, paths);
        let (mut wall, mut thread) = (Vec::new(), Vec::new());
        for _ in 0..repetitions {
            let watch = Stopwatch::start();
            run_once(ladder, paths);
            thread.push(watch.thread_s());
            wall.push(watch.wall_s());
        }
        Times { wall: Spread::of(wall), thread: Spread::of(thread), failed }
    })
}

/// Every scheme on every system, on one thread.
struct Rows<'a> {
    workload: Workload,
    progress: &'a dyn Fn(&str),
    one: ThreadPool,
    rows: Vec<SchemeRow>,
}

impl Visit for Rows<'_> {
    type Error = anyhow::Error;

    fn visit<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
        &mut self,
        setup: Setup<S, G, D, M>,
    ) -> Result<()> {
        let Workload { paths, steps, repetitions } = self.workload;
        let Setup { id, problem, implicit, explicit, .. } = setup;
        let problem = problem.until(steps as f64 * TAU)?;
        let ns = 1e9 / (paths * steps) as f64;
        for scheme in implicit.into_iter().chain(explicit) {
            (self.progress)(&format!("{} on {}", scheme.id(), id));
            let ladder = ladder(&problem, 0, vec![Run::new(scheme.as_ref(), 0)])?;
            let times = repeat(&self.one, &ladder, paths, repetitions);
            self.rows.push(SchemeRow {
                system: id,
                dimension: D,
                noises: M,
                scheme: scheme.id(),
                ns_per_path_step: times.thread.scaled(ns),
                wall_ns_per_path_step: times.wall.scaled(ns),
                failed: times.failed,
            });
        }
        Ok(())
    }
}

/// Powers of two below the number of processors, and that number.
fn counts(processors: usize) -> Vec<usize> {
    let mut counts: Vec<usize> = (0..usize::BITS)
        .map(|k| 1 << k)
        .take_while(|&threads: &usize| threads < processors)
        .collect();
    counts.push(processors);
    counts
}

/// The same work on one thread, two, four and so on, and on all processors.
fn threads(workload: Workload, progress: &dyn Fn(&str)) -> Result<Vec<ThreadRow>> {
    let problem = rigid_body_three_noises(workload.steps as f64 * TAU);
    let sexp = compiled(Sexp::default());
    let ladder = ladder(&problem, 0, vec![Run::new(sexp.as_ref(), 0)])?;
    let mut rows: Vec<ThreadRow> = Vec::new();
    for threads in counts(available_parallelism().map_or(1, usize::from)) {
        progress(&format!("{threads} threads"));
        let seconds = repeat(&pool(threads)?, &ladder, workload.paths, workload.repetitions).wall;
        let first = rows.first().map_or(seconds.best, |row| row.seconds.best);
        rows.push(ThreadRow { threads, seconds, speedup: first / seconds.best });
    }
    Ok(rows)
}

/// Each of samples and steps is multiplied by this, four times over; levels are counted up.
const FACTOR: u64 = 4;
const SIZES: u32 = 5;
/// The most levels: the coarsest of the 256 steps of the full workload must be smaller than one, or
/// truncation is not defined.
const MOST_LEVELS: u32 = 6;

/// What grows and how large it is; paths, steps and levels of the measurement.
struct Size(&'static str, u64, [u64; 3]);

fn sizes(Workload { paths, steps, .. }: Workload) -> Vec<Size> {
    let from = |largest: u64, k: u32| largest.div_ceil(FACTOR.pow(SIZES - 1)) * FACTOR.pow(k);
    let samples = (0..SIZES).map(|k| {
        let value = from(paths, k);
        Size("samples", value, [value, steps, 0])
    });
    // As much work as one of the larger sample sizes, whatever the number of steps.
    let longer = (0..SIZES).map(|k| {
        let value = from(steps * FACTOR, k);
        Size("steps", value, [paths.div_ceil(FACTOR * FACTOR), value, 0])
    });
    let most = u64::from(MOST_LEVELS.min(steps.trailing_zeros()));
    let levels = (0..=most)
        .step_by(2)
        .map(|levels| Size("levels", levels, [paths.div_ceil(FACTOR), steps, levels]));
    samples.chain(longer).chain(levels).collect()
}

/// More samples, more steps, more levels: is time linear, is memory flat?
fn growth(workload: Workload, one: &ThreadPool, progress: &dyn Fn(&str)) -> Result<Vec<GrowthRow>> {
    let sexp = compiled(Sexp::default());
    let mut rows = Vec::new();
    for Size(grows, value, [paths, steps, levels]) in sizes(workload) {
        progress(&format!("{value} {grows}"));
        let problem = rigid_body_three_noises(steps as f64 * TAU);
        let levels = levels as usize;
        let runs = (0..=levels).map(|level| Run::new(sexp.as_ref(), level)).collect();
        let ladder = ladder(&problem, levels, runs)?;
        let path_steps = ladder.steps_per_path() * paths;
        // Sets the mark of the peak back to what is in use now, where the system lets us.
        let forgotten = fs::write("/proc/self/clear_refs", "5").is_ok();
        one.install(|| run_once(&ladder, paths));
        let peak_memory_mb = if forgotten { peak_memory_mb() } else { None };
        let times = repeat(one, &ladder, paths, workload.repetitions);
        rows.push(GrowthRow {
            grows,
            value,
            path_steps,
            ns_per_path_step: times.thread.scaled(1e9 / path_steps as f64),
            peak_memory_mb,
        });
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::counts;

    #[test]
    fn all_processors_come_last_and_once() {
        assert_eq!(counts(1), [1]);
        assert_eq!(counts(2), [1, 2]);
        assert_eq!(counts(6), [1, 2, 4, 6]);
        assert_eq!(counts(8), [1, 2, 4, 8]);
    }
}
