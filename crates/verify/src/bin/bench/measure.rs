//! Every scheme on every system, and one of them with more threads, samples, steps and levels.

use std::{fs, hint::black_box, iter::successors, thread::available_parallelism};

use analysis::{FinalMoments, Spread, Stopwatch};
use anyhow::{Context, Result};
use mc::{Ladder, Run, View, bind};
use noise::StreamKey;
use plot::provenance::peak_memory_mb;
use rayon::{ThreadPool, ThreadPoolBuilder};
use real::Level;
use schemes::Sexp;
use systems::{Damping, PoissonSystem, Problem, paper::rigid_body_three_noises};
use verify::{
    compiled,
    setups::{Setup, Visit, visit_others, visit_paper},
    truncation,
};

use crate::results::{GrowthRow, SchemeRow, Speed, ThreadRow, Workload};

/// Streams of all measurements.
pub const KEY: StreamKey = StreamKey { seed: 1, experiment: verify::streams::BENCH };
/// The step size of all measurements, 2⁻⁸.
const TAU: f64 = 1.0 / 256.0;

/// Measures everything, and says on standard error what comes next.
pub fn measure(workload: Workload) -> Result<Speed> {
    let load_before = load();
    let one = pool(1)?;
    let growth = growth(workload, &one)?;
    let mut schemes = Schemes { workload, one, rows: Vec::new() };
    visit_paper(&mut schemes)?;
    visit_others(&mut schemes)?;
    Ok(Speed {
        workload,
        clock: if Stopwatch::MEASURES_PROCESSOR { "on-core" } else { "wall" },
        simd: Level::current().name(),
        optimised: !cfg!(debug_assertions),
        load_before,
        schemes: schemes.rows,
        threads: threads(workload)?,
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
    runs: Vec<Run<'a>>,
) -> Result<Ladder<'a>> {
    let steps = (problem.t_end() / TAU).round() as u64;
    Ok(Ladder::new(&mc::Problem::of(problem), steps, levels, truncation(), KEY, runs)?)
}

/// Runs the ladder on the current pool with a small statistic, the mean of the final state; returns
/// how many paths were left out.
fn run_once<const D: usize>(ladder: &Ladder<'_>, paths: u64) -> u64 {
    let state = |view: &View<'_>, p: usize, values: &mut [f64]| {
        values.copy_from_slice(&view.path::<D>(0, p));
    };
    let new = || FinalMoments::new(ladder.coarse_steps(), D, &state);
    black_box(ladder.run(paths, new, &|_| ())).failed
}

/// Runs the ladder once to warm up and then `repetitions` times, on a pool: wall time, time of a
/// single thread, both in seconds, and how many paths were left out.
fn repeat<const D: usize>(
    pool: &ThreadPool,
    ladder: &Ladder<'_>,
    Workload { paths, repetitions, .. }: Workload,
) -> (Spread, Spread, u64) {
    // The clock of the thread is read on the thread that works.
    pool.install(|| {
        let failed = run_once::<D>(ladder, paths);
        let once = |_| {
            let watch = Stopwatch::start();
            run_once::<D>(ladder, paths);
            (watch.wall_s(), watch.thread_s())
        };
        let (wall, thread) = (0..repetitions).map(once).unzip();
        (Spread::of(wall), Spread::of(thread), failed)
    })
}

/// Every scheme on every system, on one thread.
struct Schemes {
    workload: Workload,
    one: ThreadPool,
    rows: Vec<SchemeRow>,
}

impl Visit for Schemes {
    fn visit<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
        &mut self,
        setup: Setup<S, G, D, M>,
    ) -> Result<()> {
        let Workload { paths, steps, .. } = self.workload;
        let Setup { id, problem, schemes, .. } = setup;
        let problem = problem.until(steps as f64 * TAU)?;
        let ns = 1e9 / (paths * steps) as f64;
        for scheme in &schemes {
            eprintln!("{} on {}", scheme.id(), id);
            let ladder = ladder(&problem, 0, vec![Run::new(bind(&problem, scheme.as_ref()), 0)])?;
            let (wall, thread, failed) = repeat::<D>(&self.one, &ladder, self.workload);
            self.rows.push(SchemeRow {
                system: id,
                dimension: D,
                noises: M,
                scheme: scheme.id(),
                ns_per_path_step: thread.scaled(ns),
                wall_ns_per_path_step: wall.scaled(ns),
                failed,
            });
        }
        Ok(())
    }
}

/// Powers of two below the number of processors, and that number.
fn counts(processors: usize) -> Vec<usize> {
    successors(Some(1), |threads| Some(2 * threads))
        .take_while(|&threads| threads < processors)
        .chain([processors])
        .collect()
}

/// The same work on one thread, two, four and so on, and on all processors.
fn threads(workload: Workload) -> Result<Vec<ThreadRow>> {
    let problem = rigid_body_three_noises(workload.steps as f64 * TAU);
    let sexp = compiled(Sexp);
    let ladder = ladder(&problem, 0, vec![Run::new(bind(&problem, sexp.as_ref()), 0)])?;
    let mut rows: Vec<ThreadRow> = Vec::new();
    for threads in counts(available_parallelism().map_or(1, usize::from)) {
        eprintln!("{threads} threads");
        let (seconds, ..) = repeat::<3>(&pool(threads)?, &ladder, workload);
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

/// What grows and how large it is; the measurement, and its levels above the finest.
type Size = (&'static str, u64, Workload, usize);

fn sizes(workload: Workload) -> Vec<Size> {
    let Workload { paths, steps, .. } = workload;
    let values = |largest: u64| {
        (0..SIZES).map(move |k| largest.div_ceil(FACTOR.pow(SIZES - 1)) * FACTOR.pow(k))
    };
    let samples = values(paths).map(|paths| ("samples", paths, Workload { paths, ..workload }, 0));
    // As much work as one of the larger sample sizes, whatever the number of steps.
    let fewer = Workload { paths: paths.div_ceil(FACTOR * FACTOR), ..workload };
    let longer =
        values(steps * FACTOR).map(|steps| ("steps", steps, Workload { steps, ..fewer }, 0));
    let quarter = Workload { paths: paths.div_ceil(FACTOR), ..workload };
    let levels = (0..=MOST_LEVELS.min(steps.trailing_zeros()))
        .step_by(2)
        .map(|levels| ("levels", u64::from(levels), quarter, levels as usize));
    samples.chain(longer).chain(levels).collect()
}

/// More samples, more steps, more levels: is time linear, is memory flat?
fn growth(workload: Workload, one: &ThreadPool) -> Result<Vec<GrowthRow>> {
    let sexp = compiled(Sexp);
    let mut rows = Vec::new();
    for (grows, value, workload, levels) in sizes(workload) {
        eprintln!("{value} {grows}");
        let problem = rigid_body_three_noises(workload.steps as f64 * TAU);
        let runs =
            (0..=levels).map(|level| Run::new(bind(&problem, sexp.as_ref()), level)).collect();
        let ladder = ladder(&problem, levels, runs)?;
        let path_steps = ladder.steps_per_path() * workload.paths;
        // Sets the mark of the peak back to what is in use now, where the system lets us.
        let forgotten = fs::write("/proc/self/clear_refs", "5").is_ok();
        one.install(|| run_once::<3>(&ladder, workload.paths));
        let peak_memory_mb = if forgotten { peak_memory_mb() } else { None };
        let (_, thread, _) = repeat::<3>(one, &ladder, workload);
        let ns_per_path_step = thread.scaled(1e9 / path_steps as f64);
        rows.push(GrowthRow { grows, value, path_steps, ns_per_path_step, peak_memory_mb });
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
