//! `cargo xtask bench`: what a path-step costs as a user of [`mc::Ladder`] pays for it: noise,
//! truncation, scheme and statistic.
//!
//! Every scheme runs on every system, then one of them on more threads, more samples, more steps
//! and more levels. Nothing here decides whether a number is good.

use std::{
    fmt::Display, fs, hint::black_box, iter::successors, path::PathBuf, process::ExitCode,
    thread::available_parallelism, time::Instant,
};

use analysis::{FinalMoments, Spread, Stopwatch};
use anyhow::{Context, Result, ensure};
use clap::Parser;
use mc::{Ladder, Run, Setup, View};
use noise::StreamKey;
use plot::{
    files,
    provenance::{complete, peak_memory_mb},
};
use rayon::ThreadPoolBuilder;
use real::{Level, limit_to};
use schemes::BuiltIn;
use serde::Serialize;
use serde_json::json;
use systems::paper;
use verify::{Compiled, command, results::Provenance, streams, truncation};

/// Measures what a path-step costs: every scheme on every system, threads, memory, growth.
#[derive(Parser)]
#[command(name = "cargo xtask bench", version)]
struct Arguments {
    /// Write the numbers to this file, with where they come from.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// So small a workload that the numbers say only that everything runs.
    #[arg(long)]
    quick: bool,
    /// Repetitions of each measurement; 7 unless given, 2 with --quick.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    repetitions: Option<u32>,
    /// Use no wider vector instructions than these: baseline, avx2 or avx512.
    #[arg(long, value_name = "LEVEL", value_parser = command::simd)]
    simd: Option<Level>,
}

/// Streams of all measurements.
const KEY: StreamKey = StreamKey { seed: 1, experiment: streams::BENCH };
/// The step size of all measurements, 2⁻⁸.
const TAU: f64 = 1.0 / 256.0;

/// How much is run.
#[derive(Clone, Copy, Serialize)]
struct Workload {
    paths: u64,
    steps: u64,
    threads: usize,
    /// Levels above the finest.
    levels: usize,
    repetitions: u32,
}

/// One measurement.
#[derive(Serialize)]
struct Row {
    /// The system; of `sexp` on the rigid body with three noises `threads`, `samples`, `steps` or
    /// `levels`, the number that grows.
    of: &'static str,
    scheme: &'static str,
    workload: Workload,
    /// Nanoseconds for one step of one path on a core, by the clock of the thread where there is
    /// one.
    ns_per_path_step: Spread,
    /// The same by the clock on the wall.
    wall_ns_per_path_step: Spread,
    /// Largest memory of the process during this measurement; absent where the system does not
    /// tell.
    peak_memory_mb: Option<f64>,
    /// Paths that were left out.
    failed: u64,
}

fn main() -> ExitCode {
    command::exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<ExitCode> {
    let start = Instant::now();
    if let Some(level) = arguments.simd {
        limit_to(level);
    }
    if let Some(file) = &arguments.json {
        files::prepare_file(file)?;
    }
    let (mode, paths, steps, repetitions) =
        if arguments.quick { ("quick", 256, 32, 2) } else { ("full", 65_536, 256, 7) };
    let repetitions = arguments.repetitions.unwrap_or(repetitions);
    let workload = Workload { paths, steps, threads: 1, levels: 0, repetitions };
    let load = fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let clock = if Stopwatch::MEASURES_PROCESSOR { "on core" } else { "wall" };
    println!(
        "{}, best of {repetitions}, noise and statistics included, τ = 2^-8, ns ({clock}) for one \
         step of one path; load before: {}{}",
        Level::current().name(),
        load.split_whitespace().next().unwrap_or("unknown"),
        if cfg!(debug_assertions) { "; built without optimisation" } else { "" }
    );
    let mut rows = Vec::new();
    let mut every = |of, compiled: Compiled<'_>| {
        compiled.curves(&BuiltIn::ALL).into_iter().try_for_each(|mut curve| {
            curve.setup.problem.t_end = workload.steps as f64 * TAU;
            rows.push(measure(of, &curve.setup, workload)?);
            anyhow::Ok(())
        })
    };
    every("pendulum", Compiled::of(&paper::pendulum()))?;
    every("rigid-body-1", Compiled::of(&paper::rigid_body_one_noise()))?;
    every("rigid-body-3", Compiled::of(&paper::rigid_body_three_noises(1.0)))?;
    every("lotka-volterra", Compiled::of(&paper::lotka_volterra_1_1()))?;
    every("maxwell-bloch", Compiled::of(&paper::maxwell_bloch(1.0)))?;
    every("poisson3", Compiled::of(&paper::poisson3_strong()))?;
    for (of, workload) in sizes(workload) {
        let problem = paper::rigid_body_three_noises(workload.steps as f64 * TAU);
        rows.push(measure(of, &Compiled::of(&problem).sexp(), workload)?);
    }
    println!("{}", table(&rows));
    let failed: u64 = rows.iter().map(|row| row.failed).sum();
    if let Some(file) = &arguments.json {
        let provenance = Provenance::of_run(KEY.seed, mode);
        let provenance = complete(provenance, "cargo xtask bench", start);
        // The schema is raised whenever a reader of an older version would misread a newer one.
        files::write_json(file, &json!({ "schema": 2, "provenance": provenance, "rows": rows }))?;
        println!("numbers: {}", file.display());
    }
    ensure!(failed == 0, "{failed} paths had no solution: their time is not that of a step");
    Ok(ExitCode::SUCCESS)
}

/// The time of a scheme on every level, with a small statistic, the mean of the final state; once
/// to warm up and then as often as wanted.
fn measure(of: &'static str, setup: &Setup<'_>, workload: Workload) -> Result<Row> {
    let (Setup { problem, scheme }, id) = (setup, setup.scheme.id());
    let Workload { paths, steps, threads, levels, repetitions } = workload;
    eprintln!("{of}, {id}");
    let runs = (0..=levels).map(|level| Run::new(scheme.clone(), level)).collect();
    let ladder = Ladder::new(problem, steps, levels, truncation(), KEY, runs)?;
    let state = |view: &View<'_>, rows: &mut [real::Row]| rows.copy_from_slice(view.state(0));
    let new = || FinalMoments::new(ladder.coarse_steps(), problem.y0.len(), &state);
    let once = || black_box(ladder.run(paths, new, &|_| ())).failed;
    // Sets the mark of the peak back to what is in use now, where the system lets us.
    let forgotten = fs::write("/proc/self/clear_refs", "5").is_ok();
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    // The clock of the thread is read on the thread that works.
    let (failed, wall, thread) = pool.context("cannot start the threads")?.install(|| {
        let failed = once();
        let time = |_| {
            let watch = Stopwatch::start();
            once();
            (watch.wall_s(), watch.thread_s())
        };
        let (wall, thread) = (0..repetitions).map(time).unzip();
        (failed, Spread::of(wall), Spread::of(thread))
    });
    let ns = 1e9 / (ladder.steps_per_path() * paths) as f64;
    Ok(Row {
        of,
        scheme: id,
        workload,
        ns_per_path_step: if threads > 1 { &wall } else { &thread }.scaled(ns),
        wall_ns_per_path_step: wall.scaled(ns),
        peak_memory_mb: peak_memory_mb().filter(|_| forgotten),
        failed,
    })
}

/// More threads up to all processors, then more samples, steps and levels.
fn sizes(workload: Workload) -> Vec<(&'static str, Workload)> {
    let processors = available_parallelism().map_or(1, usize::from);
    let fewer = successors(Some(1), |threads| Some(2 * threads)).take_while(|&n| n < processors);
    let threads =
        fewer.chain([processors]).map(|threads| ("threads", Workload { threads, ..workload }));
    let few = Workload { paths: workload.paths.div_ceil(16), ..workload };
    // The coarsest step must be smaller than one, or truncation is not defined.
    let levels = few.steps.trailing_zeros().min(6) as usize;
    let growing = [
        ("samples", few),
        ("samples", workload),
        ("steps", few),
        ("steps", Workload { steps: 4 * few.steps, ..few }),
        ("levels", few),
        ("levels", Workload { levels, ..few }),
    ];
    threads.chain(growing).collect()
}

fn table(rows: &[Row]) -> comfy_table::Table {
    let header = [
        "of", "scheme", "paths", "steps", "threads", "levels", "best", "median", "wall", "peak MB",
    ];
    let row = |row: &Row| {
        let Workload { paths, steps, threads, levels, .. } = row.workload;
        let Spread { best, median, .. } = row.ns_per_path_step;
        let cells: [&dyn Display; 6] = [&row.of, &row.scheme, &paths, &steps, &threads, &levels];
        let numbers = [best, median, row.wall_ns_per_path_step.best].map(Some);
        let numbers = numbers.into_iter().chain([row.peak_memory_mb]);
        let numbers = numbers.map(|x| x.map_or("unknown".into(), |x| format!("{x:.2}")));
        cells.into_iter().map(ToString::to_string).chain(numbers).collect::<Vec<_>>()
    };
    command::table(header, 2, rows.iter().map(row))
}
