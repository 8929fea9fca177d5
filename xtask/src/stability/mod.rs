//! `cargo xtask stability`: hard cases, long times, arbitrary inputs.

mod command_line;
mod curves;
mod page;

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Result;
use clap::Args;
use report::{Page, files, provenance};
use stability::results::{Provenance, SCHEMA, Stability as Results};
use stability::{Effort, Settings};

/// Arguments of `cargo xtask stability`.
#[derive(Args)]
pub struct Stability {
    /// Fewer paths, steps and inputs: seconds instead of minutes.
    #[arg(long)]
    quick: bool,
    /// Run only this case, or `growth`, or `fuzz`; may be given several times.
    #[arg(long, value_name = "ID")]
    only: Vec<String>,
    /// Inputs for the cheapest fuzzed targets, fewer for the others; by default as many as take a
    /// minute, with --quick a second.
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

/// What can be asked for beside the cases.
const PARTS: [&str; 2] = ["growth", "fuzz"];

/// Runs everything, and writes JSON, figures and page. Fails when a guarantee is refuted.
pub fn run(arguments: &Stability) -> Result<ExitCode> {
    check(&arguments.only)?;
    let first = arguments.out.join("stability.md");
    let pages = || [Some(&first), arguments.page.as_ref()].into_iter().flatten();
    pages().try_for_each(|file| files::prepare_file(file))?;
    let start = Instant::now();
    let mut results = measure(arguments);
    results.provenance = provenance::complete(results.provenance, "cargo xtask", start);
    files::write_json(&arguments.out.join("stability.json"), &results)?;
    let page = page::page(&results);
    pages().try_for_each(|file| page.write(file))?;
    let mut summary = Page::new("Stability");
    page::summary(&mut summary, &results);
    print!("{}", summary.text());
    println!("{:.0} s; page: {}", results.provenance.wall_s, first.display());
    Ok(if results.refuted() == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn measure(arguments: &Stability) -> Results {
    let (effort, mode) =
        if arguments.quick { (Effort::Quick, "quick") } else { (Effort::Full, "full") };
    let settings = Settings { seed: arguments.seed, effort };
    let begin = |name: &str| eprintln!("{name}");
    let only = &arguments.only;
    let wanted = |part: &str| only.is_empty() || only.iter().any(|id| id == part);
    let is_part = |id: &&String| PARTS.contains(&id.as_str());
    // With nothing but parts asked for, no case is run.
    let no_case = !only.is_empty() && only.iter().all(|id| is_part(&id));
    let cases: Vec<String> = only.iter().filter(|id| !is_part(id)).cloned().collect();
    let run = |target| stability::fuzz::run(settings, arguments.inputs, &[target], &begin);
    Results {
        schema: SCHEMA,
        provenance: Provenance {
            seed: arguments.seed,
            mode: mode.to_owned(),
            threads: rayon::current_num_threads(),
            ..Provenance::default()
        },
        cases: if no_case { Vec::new() } else { stability::run_cases(settings, &cases, &begin) },
        growth: if wanted("growth") { stability::run_growth(settings, &begin) } else { Vec::new() },
        fuzz: if wanted("fuzz") { run(command_line::target()) } else { Vec::new() },
    }
}

fn check(ids: &[String]) -> Result<()> {
    let known = [stability::case_ids(), PARTS.to_vec()].concat();
    match ids.iter().find(|id| !known.contains(&id.as_str())) {
        None => Ok(()),
        Some(id) => anyhow::bail!("there is no case {id:?}; there are {}", known.join(", ")),
    }
}
