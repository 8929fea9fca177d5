//! `cargo xtask reproduce`: runs the experiments of the paper, prints a verdict for every statement
//! and writes a report with figures, tables and `results.json`.

use std::{path::PathBuf, process::ExitCode, time::Instant};

use anyhow::Result;
use clap::{Parser, builder::PossibleValuesParser};
use mc::parts::limit_threads;
use plot::{Bars, files, provenance};
use real::{Level, limit_to};
use schemes::BuiltIn;
use verify::{
    EXPERIMENTS, FURTHER, Mode, STATEMENTS, SUPPLEMENTS, Settings, command,
    page::{self, Outcome},
    results::{Claim, Results},
};

/// Runs the paper's experiments, prints the verdicts and writes the report.
#[derive(Parser)]
#[command(name = "cargo xtask reproduce", version)]
struct Arguments {
    /// Fewer steps and samples: seconds instead of a minute, wide intervals, verdicts often
    /// undecided.
    #[arg(long)]
    quick: bool,
    /// Run only this panel or statement; may be given several times.
    #[arg(long, value_name = "ID", value_parser = PossibleValuesParser::new(all_ids()))]
    only: Vec<String>,
    /// Schemes that are not in the paper and are further series of its panels, separated by commas,
    /// or none.
    #[arg(long, value_name = "SCHEMES", default_value = "sexp-levy", value_delimiter = ',')]
    #[arg(value_parser = PossibleValuesParser::new(further()))]
    with: Vec<String>,
    /// Master seed, 0 to 2^64 − 1; the same seed gives the same results on any number of threads
    /// and any vectors.
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    seed: u64,
    /// Multiply the numbers of paths by X, in whole groups of 128. With 1 or more.
    #[arg(long, value_name = "X", value_parser = times)]
    samples_times: Option<f64>,
    /// Worker threads; all processors unless given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Folder for the report; created if it does not exist.
    #[arg(long, value_name = "DIR", default_value = "target/reproduce")]
    out: PathBuf,
    /// Use no wider vector instructions than these; the results are the same, only slower.
    #[arg(long, value_parser = command::simd, value_name = "LEVEL")]
    simd: Option<Level>,
}

/// A factor for numbers of paths.
fn times(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(times @ 1.0..=1e9) => Ok(times),
        _ => Err("a number from 1 to 1e9 is wanted".to_owned()),
    }
}

/// What `--only` may name.
fn all_ids() -> impl Iterator<Item = &'static str> {
    [EXPERIMENTS, STATEMENTS, SUPPLEMENTS].into_iter().flat_map(verify::ids)
}

/// What `--with` may name.
fn further() -> impl Iterator<Item = &'static str> {
    ["none"].into_iter().chain(FURTHER.map(BuiltIn::id))
}

fn main() -> ExitCode {
    command::exit_code(run(&Arguments::parse()))
}

/// Runs the experiments and writes the report. Succeeds unless something that the paper proves is
/// refuted.
fn run(arguments: &Arguments) -> Result<ExitCode> {
    if let Some(level) = arguments.simd {
        limit_to(level);
    }
    files::prepare(&arguments.out)?;
    arguments.threads.map_or(Ok(()), |threads| limit_threads(threads.into()))?;
    let mode = if arguments.quick { Mode::Quick } else { Mode::Paper };
    let samples_times = arguments.samples_times;
    let settings = Settings { samples_times, ..Settings::new(arguments.seed, mode) };
    let mut further = FURTHER.to_vec();
    further.retain(|method| arguments.with.iter().any(|name| name == method.id()));

    let (start, bars) = (Instant::now(), Bars::default());
    let only: Vec<&str> = arguments.only.iter().map(String::as_str).collect();
    let mut results = verify::reproduce(settings, &only, &further, &bars);
    bars.finish();
    results.provenance = provenance::complete(results.provenance, "cargo xtask reproduce", start);
    files::write_json(&arguments.out.join("results.json"), &results)?;
    page::write_report(&results, &arguments.out)?;
    print_summary(&results, arguments);
    Ok(if results.claims.iter().any(fails) { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}

/// A proven statement that is refuted, and not for a documented misprint in it.
fn fails(claim: &Claim) -> bool {
    claim.proven && Outcome::of(claim) == Outcome::Refuted
}

fn print_summary(results: &Results, arguments: &Arguments) {
    println!("{}", page::verdicts(&results.claims));
    let provenance = &results.provenance;
    for (id, seconds) in &provenance.wall_s_by_id {
        println!("{seconds:8.2} s  {id}");
    }
    let memory = provenance::peak_memory_mb().map(|mb| format!(", peak memory {mb:.0} MB"));
    println!(
        "{:8.2} s  in all, {} threads, {}{}",
        provenance.wall_s,
        provenance.threads,
        provenance.simd,
        memory.unwrap_or_default()
    );
    println!("{}", page::counts(&results.claims));
    for claim in results.claims.iter().filter(|claim| fails(claim)) {
        println!("REFUTED: {} on {}: {}", claim.id, claim.panel, claim.evidence);
    }
    println!("report: {}", arguments.out.join("index.html").display());
}
