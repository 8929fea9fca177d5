//! `cargo xtask reproduce`: runs the experiments of the paper, prints a verdict for every statement
//! and writes a report with figures, tables and `results.json`.

use std::{path::PathBuf, process::ExitCode, time::Instant};

use anyhow::Result;
use clap::{Parser, builder::PossibleValuesParser};
use mc::{files, parts::limit_threads};
use plot::provenance;
use real::{Simd, limit_to};
use verify::{EXPERIMENTS, STATEMENTS, SUPPLEMENTS, command, page, results::Claim};

/// Runs the paper's experiments, prints the verdicts and writes the report.
#[derive(Parser)]
#[command(name = "cargo xtask reproduce", version)]
struct Arguments {
    /// Fewer steps and samples: seconds instead of a minute, wide intervals, verdicts often
    /// undecided.
    #[arg(long)]
    quick: bool,
    /// Run only this panel or statement; may be given several times.
    #[arg(long, value_name = "ID", value_parser = PossibleValuesParser::new(
        [EXPERIMENTS, STATEMENTS, SUPPLEMENTS].into_iter().flat_map(verify::ids)
    ))]
    only: Vec<String>,
    /// Master seed, 0 to 2^64 − 1; the same seed gives the same results on any number of threads
    /// and any vectors.
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    seed: u64,
    /// Worker threads; all processors unless given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Folder for the report; created if it does not exist.
    #[arg(long, value_name = "DIR", default_value = "target/reproduce")]
    out: PathBuf,
    /// Use no wider vector instructions than these; the results are the same, only slower.
    #[arg(long, value_parser = command::simd, value_name = "LEVEL")]
    simd: Option<Simd>,
}

/// Runs the experiments and writes the report. Succeeds unless something that the paper proves is
/// refuted, and not for a documented misprint in it.
fn main() -> Result<ExitCode> {
    let start = Instant::now();
    let Arguments { quick, only, seed, threads, out, simd } = Arguments::parse();
    simd.into_iter().for_each(limit_to);
    files::prepare(&out)?;
    threads.map_or(Ok(()), |threads| limit_threads(threads.into()))?;
    let only: Vec<&str> = only.iter().map(String::as_str).collect();
    let mut results = verify::reproduce(seed, quick, &only);
    let commit = option_env!("CASIMIR_COMMIT");
    results.provenance =
        provenance::complete(results.provenance, "cargo xtask reproduce", commit, start);
    files::write_json(&out.join("results.json"), &results)?;
    page::write_report(&results, &out)?;
    for (id, seconds) in &results.provenance.wall_s_by_id {
        println!("{seconds:8.2} s  {id}");
    }
    let mut failed = false;
    for claim in &results.claims {
        let Claim { id, panel, scheme, evidence, proven, .. } = claim;
        let (outcome, kind) = (claim.outcome(), if *proven { ", proven" } else { "" });
        println!("{outcome}{kind}: {id} {panel} {scheme}: {evidence}");
        failed |= *proven && outcome == "refuted";
    }
    println!("{}", page::counts(results.claims.iter()));
    println!("report: {}", out.join("index.html").display());
    Ok(if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}
