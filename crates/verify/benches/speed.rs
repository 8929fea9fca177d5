//! `cargo xtask bench`: what a path-step costs as a user of [`mc::Ladder`] pays for it: noise,
//! truncation, scheme and statistic.
//!
//! Every scheme runs on every system, then one of them on more threads, more samples, more steps
//! and more levels. Nothing here decides whether a number is good.

use std::{
    fs, hint::black_box, path::PathBuf, process::ExitCode, thread::available_parallelism,
    time::Instant,
};

use analysis::{FinalMoments, Spread, Stopwatch, number};
use anyhow::{Context, Result, ensure};
use clap::Parser;
use mc::{Ladder, Run, Setup, View, files};
use noise::StreamKey;
use plot::provenance::complete;
use rayon::ThreadPoolBuilder;
use real::{Simd, limit_to};
use schemes::BuiltIn;
use serde::Serialize;
use serde_json::{Value, json};
use systems::paper;
use verify::{Compiled, command, results::Provenance, streams, truncation};

/// Measures what a path-step costs: every scheme on every system, threads, memory, growth.
#[derive(Parser)]
#[command(name = "cargo xtask bench", version)]
struct Arguments {
    /// Write the numbers to this file, with where they come from.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Given by cargo.
    #[arg(long, hide = true)]
    bench: bool,
    /// So small a workload that the numbers say only that everything runs.
    #[arg(long)]
    quick: bool,
    /// Use no wider vector instructions than these: baseline, avx2 or avx512.
    #[arg(long, value_name = "LEVEL", value_parser = command::simd)]
    simd: Option<Simd>,
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

fn main() -> Result<ExitCode> {
    run(&Arguments::parse())
}

fn run(arguments: &Arguments) -> Result<ExitCode> {
    let start = Instant::now();
    arguments.simd.into_iter().for_each(limit_to);
    arguments.json.as_deref().map_or(Ok(()), |file| files::prepare(files::folder(file)))?;
    let (mode, paths, steps, repetitions) =
        if arguments.quick { ("quick", 256, 32, 2) } else { ("full", 65_536, 256, 7) };
    let workload = Workload { paths, steps, threads: 1, levels: 0, repetitions };
    println!("ns for one step of one path on a core, {}", Simd::current().name());
    println!("of, scheme, paths, steps, threads, levels: best, median");
    let mut rows = Vec::new();
    for (of, compiled) in [
        ("pendulum", Compiled::of(&paper::pendulum())),
        ("rigid-body-1", Compiled::of(&paper::rigid_body_one_noise())),
        ("rigid-body-3", Compiled::of(&paper::rigid_body_three_noises(1.0))),
        ("lotka-volterra", Compiled::of(&paper::lotka_volterra_1_1())),
        ("maxwell-bloch", Compiled::of(&paper::maxwell_bloch(1.0))),
        ("poisson3", Compiled::of(&paper::poisson3_strong())),
    ] {
        for mut curve in compiled.curves(&BuiltIn::ALL) {
            curve.setup.problem.t_end = steps as f64 * TAU;
            rows.push(measure(of, &curve.setup, workload)?);
        }
    }
    // All processors, then more samples, steps and levels; the coarsest step must be smaller than
    // one, or truncation is not defined.
    let threads = available_parallelism().map_or(1, usize::from);
    let few = Workload { paths: paths.div_ceil(16), ..workload };
    let growing = [
        ("threads", workload),
        ("threads", Workload { threads, ..workload }),
        ("samples", few),
        ("samples", workload),
        ("steps", few),
        ("steps", Workload { steps: 4 * steps, ..few }),
        ("levels", few),
        ("levels", Workload { levels: steps.trailing_zeros().min(6) as usize, ..few }),
    ];
    for (of, workload) in growing {
        let problem = paper::rigid_body_three_noises(workload.steps as f64 * TAU);
        rows.push(measure(of, &Compiled::of(&problem).sexp(), workload)?);
    }
    if let Some(file) = &arguments.json {
        let provenance = Provenance::of_run(KEY.seed, mode);
        let commit = option_env!("CASIMIR_COMMIT");
        let provenance = complete(provenance, "cargo xtask bench", commit, start);
        // The schema is raised whenever a reader of an older version would misread a newer one.
        files::write_json(file, &json!({ "schema": 2, "provenance": provenance, "rows": rows }))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Largest resident memory of this process so far in MB; none where the system does not tell.
fn peak_memory_mb() -> Option<f64> {
    let text = fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.strip_suffix("kB")?.trim().parse::<f64>().ok()? / 1024.0)
}

/// The time of a scheme on every level, with a small statistic, the mean of the final state; once
/// to warm up and then as often as wanted. A row says what it is of: the system, or of `sexp` on
/// the rigid body with three noises `threads`, `samples`, `steps` or `levels`, the number that
/// grows; nanoseconds for one step of one path on a core, by the clock of the thread where there is
/// one, and by the clock on the wall; and the largest memory meanwhile, null where the system does
/// not tell.
fn measure(of: &str, setup: &Setup<'_>, workload: Workload) -> Result<Value> {
    let (Setup { problem, scheme }, id) = (setup, setup.scheme.about().id);
    let Workload { paths, steps, threads, levels, repetitions } = workload;
    let runs = (0..=levels).map(|level| Run::new(scheme.clone(), level)).collect();
    let ladder = Ladder::new(problem, steps, levels, truncation(), KEY, runs)?;
    let state = |view: &View<'_>, rows: &mut [real::Row]| rows.copy_from_slice(view.state(0));
    let new = || FinalMoments::new(ladder.coarse_steps(), problem.y0.len(), &state);
    let once = || black_box(ladder.run(paths, new)).failed;
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
    let ns_per_path_step = if threads > 1 { &wall } else { &thread }.scaled(ns);
    let [best, median] = [ns_per_path_step.best, ns_per_path_step.median].map(number);
    println!("{of}, {id}, {paths}, {steps}, {threads}, {levels}: {best}, {median}");
    ensure!(failed == 0, "{failed} paths had no solution: their time is not that of a step");
    Ok(json!({
        "of": of,
        "scheme": id,
        "workload": workload,
        "ns_per_path_step": ns_per_path_step,
        "wall_ns_per_path_step": wall.scaled(ns),
        "peak_memory_mb": peak_memory_mb().filter(|_| forgotten),
        "failed": failed,
    }))
}
