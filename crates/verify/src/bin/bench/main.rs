//! `cargo xtask bench`: what a path-step costs as a user of [`mc::Ladder`] pays for it: noise,
//! truncation, scheme and statistic.
//!
//! Every scheme runs on every system, then one of them on more threads, more samples, more steps
//! and more levels. Nothing here decides whether a number is good.

mod measure;
mod results;
mod table;

use std::{path::PathBuf, process::ExitCode, time::Instant};

use anyhow::{Result, ensure};
use clap::Parser;
use plot::{files, provenance};
use real::{Level, limit_to};
use verify::command;
use verify::results::Provenance;

use results::{Report, Workload};

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
    let (mode, mut workload) =
        if arguments.quick { ("quick", Workload::QUICK) } else { ("full", Workload::FULL) };
    workload.repetitions = arguments.repetitions.unwrap_or(workload.repetitions);
    let speed = measure::measure(workload)?;
    // What was measured is shown even where the file cannot be written.
    println!("{}", table::page(&speed));
    let failed: u64 = speed.schemes.iter().map(|row| row.failed).sum();
    if let Some(file) = &arguments.json {
        let provenance = provenance::complete(
            Provenance::of_run(measure::KEY.seed, mode),
            "cargo xtask bench",
            start,
        );
        files::write_json(file, &Report { schema: results::SCHEMA, provenance, speed })?;
        println!("numbers: {}", file.display());
    }
    ensure!(failed == 0, "{failed} paths had no solution: their time is not that of a step");
    Ok(ExitCode::SUCCESS)
}
