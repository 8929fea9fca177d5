//! Measures and prints what a path-step costs. `cargo xtask bench` builds this with optimisation
//! and runs it.

mod table;

use std::fs;
use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use clap::{Parser, ValueEnum};
use real::{Level, limit_to};
use speed::{Workload, measure};

/// Measures what a path-step costs.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    /// Write the results to this file, too.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// So small a workload that the numbers say only that everything runs.
    #[arg(long)]
    quick: bool,
    /// Repetitions of each measurement; 7 unless given, 2 with --quick.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    repetitions: Option<u32>,
    /// Use no wider vector instructions than these.
    #[arg(long, value_enum, value_name = "LEVEL")]
    simd: Option<Simd>,
}

/// Instruction sets by name.
#[derive(Clone, Copy, ValueEnum)]
enum Simd {
    Baseline,
    Avx2,
    Avx512,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    if let Some(simd) = arguments.simd {
        limit_to(match simd {
            Simd::Baseline => Level::Baseline,
            Simd::Avx2 => Level::Avx2,
            Simd::Avx512 => Level::Avx512,
        });
    }
    let mut workload = if arguments.quick { Workload::quick() } else { Workload::full() };
    if let Some(repetitions) = arguments.repetitions {
        workload.repetitions = repetitions;
    }
    let speed = measure(&workload, &|next| eprintln!("{next}"))?;
    // What was measured is shown even where the file cannot be written.
    println!("{}", table::page(&speed));
    if let Some(file) = &arguments.json {
        let mut json = serde_json::to_vec_pretty(&speed)?;
        json.push(b'\n');
        fs::write(file, json).with_context(|| format!("cannot write {}", file.display()))?;
    }
    let failed: u64 = speed.schemes.iter().map(|row| row.failed).sum();
    ensure!(failed == 0, "{failed} paths had no solution: their time is not that of a step");
    Ok(())
}
