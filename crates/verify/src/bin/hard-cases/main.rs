//! **Hard inputs: what exact mathematics says, what every scheme does, and what is guaranteed.**
//!
//! `cargo xtask stability`. Each case runs all schemes on inputs that break numerical codes:
//! damping factors that underflow, rates that are infinite, noise past the contraction bound,
//! states of 10¹⁵⁰, ten million steps, a million periods. A guarantee is a derived bound; a row reports whether it
//! holds, whether a scheme fails where theory predicts failure, or that the guarantee is refuted.
//! The fuzzer feeds arbitrary bit patterns to constructors, functions and steps.

mod case;
mod cases;
mod energy;
mod figures;
mod fuzz;
mod growth;
mod page;
mod paths;
mod results;
mod rounding;
mod row;
mod schemes;

use std::{path::PathBuf, process::ExitCode, time::Instant};

use analysis::results::Provenance;
use anyhow::Result;
use clap::{Parser, builder::PossibleValuesParser};
use report::{Page, files, provenance};
use verify::command;

use results::{SCHEMA, Stability};

/// Hard cases, ten million steps and arbitrary inputs: what is guaranteed and what happens.
#[derive(Parser)]
#[command(bin_name = "cargo xtask stability", version)]
struct Arguments {
    /// Fewer paths, steps and inputs: seconds instead of minutes.
    #[arg(long)]
    quick: bool,
    /// Run only this case, or `growth`, `energy` or `fuzz`; may be given several times.
    #[arg(long, value_name = "ID", value_parser = PossibleValuesParser::new(parts()))]
    only: Vec<String>,
    /// Inputs of the cheapest fuzzed targets, fewer for the others; by default about a minute's
    /// worth, with --quick a second's.
    #[arg(long, value_name = "N")]
    inputs: Option<u64>,
    /// Master seed, 0 to 2^64 − 1; the same seed gives the same bits.
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    seed: u64,
    /// Folder for stability.json, the page and its figures; created if it does not exist.
    #[arg(long, value_name = "DIR", default_value = "target/stability")]
    out: PathBuf,
    /// Write the page here, too, with its figures in the folder `figures` beside it.
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
}

const GROWTH: &str = "growth";
const ENERGY: &str = "energy";
const FUZZ: &str = "fuzz";

/// What can be run alone.
fn parts() -> impl Iterator<Item = &'static str> {
    cases::CASES.iter().map(|case| case.id).chain([GROWTH, ENERGY, FUZZ])
}

impl Arguments {
    /// `full`, or `quick` where seconds count.
    fn many(&self, full: u64, quick: u64) -> u64 {
        if self.quick { quick } else { full }
    }

    /// Whether a case or a part is asked for; it is then announced.
    fn wants(&self, id: &str) -> bool {
        let wanted = self.only.is_empty() || self.only.iter().any(|name| name == id);
        if wanted {
            eprintln!("{id}");
        }
        wanted
    }
}

fn main() -> ExitCode {
    command::exit_code(run(&Arguments::parse()))
}

/// Runs everything, and writes JSON, figures and page. Fails when a guarantee is refuted.
fn run(arguments: &Arguments) -> Result<ExitCode> {
    files::prepare(&arguments.out)?;
    if let Some(page) = &arguments.page {
        files::prepare_file(page)?;
    }
    let start = Instant::now();
    let growth = if arguments.wants(GROWTH) { growth::run(arguments)? } else { Vec::new() };
    let cases = cases::run(arguments)?;
    let energy = if arguments.wants(ENERGY) { energy::run(arguments)? } else { Vec::new() };
    let fuzz = if arguments.wants(FUZZ) { fuzz::run(arguments) } else { Vec::new() };
    let mode = if arguments.quick { "quick" } else { "full" };
    let provenance = provenance::complete(
        Provenance::of_run(arguments.seed, mode),
        "cargo xtask stability",
        start,
    );
    let results = Stability { schema: SCHEMA, provenance, cases, growth, energy, fuzz };
    files::write_json(&arguments.out.join("stability.json"), &results)?;
    let page = page::page(&results);
    for file in [&arguments.out.join("stability.md")].into_iter().chain(&arguments.page) {
        page.write(file)?;
    }
    let mut summary = Page::new("Stability");
    page::summary(&mut summary, &results);
    print!("{}", summary.text());
    println!("{:.0} s; page in {}", results.provenance.wall_s, arguments.out.display());
    Ok(if results.refuted() == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
