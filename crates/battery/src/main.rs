//! `cargo xtask verify`: all statements for many master seeds, all twins, the coverage of the
//! intervals, the library of known answers, and the page `docs/verification.md`.

use std::{path::PathBuf, process::ExitCode, time::Instant};

use anyhow::Result;
use battery::{
    library,
    page::{self, Battery},
    twins::measure_twins,
};
use clap::{Parser, value_parser};
use lab::{EXPERIMENTS, Experiment, Method, STATEMENTS, SUPPLEMENTS, command, ids};
use report::{Bars, files, terminal};
use verify::{Mode, Settings, results::Claim};

/// Runs the whole battery for many seeds, with all wrong twins, and writes docs/verification.md.
#[derive(Parser)]
#[command(name = "cargo xtask verify", version)]
struct Arguments {
    /// Master seeds 1 … N.
    #[arg(long, value_name = "N", default_value_t = 20)]
    #[arg(value_parser = value_parser!(u64).range(1..))]
    seeds: u64,
    /// Replications behind each coverage figure.
    #[arg(long, value_name = "N", default_value_t = 4000)]
    #[arg(value_parser = value_parser!(u64).range(100..))]
    replications: u64,
    /// Seeds of the library of known answers.
    #[arg(long, value_name = "N", default_value_t = 20)]
    #[arg(value_parser = value_parser!(u64).range(5..))]
    library_seeds: u64,
    /// Half-width of the intervals of the expectations.
    #[arg(long, value_name = "ACCURACY", default_value_t = 2e-5, value_parser = accuracy)]
    accuracy: f64,
    /// The page to write.
    #[arg(long, value_name = "FILE", default_value = "docs/verification.md")]
    out: PathBuf,
}

/// A half-width that can be reached: at 1e-6 the cost would be days.
fn accuracy(text: &str) -> Result<f64, String> {
    let accuracy: f64 = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
    match accuracy {
        1e-6..1.0 => Ok(accuracy),
        _ => Err(format!("the half-width must be at least 1e-6 and below 1, got {accuracy}")),
    }
}

fn main() -> ExitCode {
    command::exit_code(run(&Arguments::parse()))
}

/// Runs the battery. Succeeds when nothing is refuted, documented misprints aside, and every twin
/// is.
fn run(arguments: &Arguments) -> Result<ExitCode> {
    files::prepare_file(&arguments.out)?;
    let start = Instant::now();
    let bars = Bars::default();
    let mut battery = Battery::default();
    for seed in 1..=arguments.seeds {
        battery.claims.push(claims(seed, &bars)?);
        battery.twins.push(measure_twins(Settings { seed, mode: Mode::Quick }, &bars));
        bars.println(&progress(&battery, arguments.seeds, start.elapsed().as_secs_f64()));
    }
    bars.println("expectations");
    let settings = Settings { seed: 1, mode: Mode::Paper };
    battery.expectations = lab::expectation_claims(settings, arguments.accuracy, &bars);
    bars.println("coverage of the intervals");
    battery.coverage = battery::coverage(arguments.replications, 1);
    bars.println("the library of known answers");
    battery.library = library::ask(&library::entries(), 1..arguments.library_seeds + 1, &|| ());
    bars.finish();
    page::page(&battery).write(&arguments.out)?;
    let false_answers = battery.false_answers();
    let alarms = battery.false_alarms() + false_answers.len();
    let missed = battery.missed_twins() + battery.missed_rules();
    println!(
        "{} seeds in {:.0} s: {alarms} false alarms, {missed} twins not refuted",
        arguments.seeds,
        start.elapsed().as_secs_f64()
    );
    println!("page: {}", arguments.out.display());
    Ok(if alarms + missed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// The last seed in a line: its verdicts, everything that went wrong so far, and the time.
fn progress(battery: &Battery, seeds: u64, seconds: f64) -> String {
    let done = battery.claims.len();
    let last = terminal::counts(&battery.claims[done - 1]);
    format!(
        "seed {done} of {seeds}: {last}; so far {} false alarms, {} twins not refuted; \
         {seconds:.0} s, about {:.0} s left",
        battery.false_alarms(),
        battery.missed_twins(),
        seconds / done as f64 * (seeds as f64 - done as f64)
    )
}

/// All claims for one seed, at the paper's sizes; what takes long is small but for the first seed.
fn claims(seed: u64, bars: &Bars) -> Result<Vec<Claim>> {
    let all = [EXPERIMENTS, STATEMENTS, SUPPLEMENTS].concat();
    let (long, short): (Vec<_>, Vec<_>) =
        all.into_iter().partition(|experiment| experiment.takes_long);
    let run = |mode, experiments: &[Experiment]| {
        lab::reproduce(Settings { seed, mode }, &ids(experiments), &Method::FURTHER, bars)
    };
    let mut claims = run(Mode::Paper, &short)?.claims;
    claims.extend(run(if seed == 1 { Mode::Paper } else { Mode::Quick }, &long)?.claims);
    Ok(claims)
}
