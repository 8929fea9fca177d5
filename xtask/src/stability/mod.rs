//! `cargo xtask stability`: hard cases, long times, arbitrary inputs.

mod command_line;
mod curves;
mod page;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Context, Result};
use clap::Args;
use stability::results::{Provenance, SCHEMA, Stability as Results};
use stability::{Effort, Settings};

use crate::{output, provenance};

/// Arguments of `cargo xtask stability`.
#[derive(Args)]
pub struct Stability {
    /// Fewer paths, steps and inputs: seconds instead of minutes.
    #[arg(long)]
    quick: bool,
    /// Run only this case, or `growth`, or `fuzz`; may be given several times.
    #[arg(long, value_name = "ID")]
    only: Vec<String>,
    /// Inputs for the cheapest fuzzed targets, fewer for the others; by default about a minute's
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

/// What can be asked for beside the cases.
const PARTS: [&str; 2] = ["growth", "fuzz"];

/// Runs everything, and writes JSON, figures and page. Fails when a guarantee is refuted.
pub fn run(arguments: &Stability) -> Result<ExitCode> {
    check(&arguments.only)?;
    prepare(&arguments.out)?;
    if let Some(page) = &arguments.page {
        anyhow::ensure!(!page.is_dir(), "{} is a folder; name a file", page.display());
        prepare(folder(page))?;
    }
    let start = Instant::now();
    let mut results = measure(arguments);
    results.provenance = Provenance {
        git: provenance::git(),
        rustc: provenance::rustc(),
        cpu: provenance::cpu(),
        simd: provenance::simd(),
        threads: rayon::current_num_threads(),
        command: crate::work_precision::command_line(),
        wall_s: start.elapsed().as_secs_f64(),
        ..results.provenance
    };
    let mut json = serde_json::to_vec_pretty(&results)?;
    json.push(b'\n');
    output::write(&arguments.out.join("stability.json"), &json)?;
    let text = page::page(&results);
    write(&arguments.out.join("stability.md"), &text, &results)?;
    if let Some(page) = &arguments.page {
        write(page, &text, &results)
            .context("everything is measured, but the second page cannot be written")?;
    }
    print!("{}", page::summary(&results));
    let seconds = results.provenance.wall_s;
    println!("{seconds:.0} s; page: {}", arguments.out.join("stability.md").display());
    Ok(if results.refuted() == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn measure(arguments: &Stability) -> Results {
    let effort = if arguments.quick { Effort::Quick } else { Effort::Full };
    let settings = Settings { seed: arguments.seed, effort };
    let begin = |name: &str| eprintln!("{name}");
    let wanted =
        |part: &str| arguments.only.is_empty() || arguments.only.iter().any(|id| id == part);
    // The parts are no cases: with nothing but parts asked for, no case is run.
    let cases: Vec<String> =
        arguments.only.iter().filter(|id| !PARTS.contains(&id.as_str())).cloned().collect();
    let any_case = arguments.only.is_empty() || !cases.is_empty();
    let mode = if arguments.quick { "quick" } else { "full" };
    Results {
        schema: SCHEMA,
        provenance: Provenance {
            seed: arguments.seed,
            mode: mode.to_owned(),
            ..Provenance::default()
        },
        cases: if any_case { stability::run_cases(settings, &cases, &begin) } else { Vec::new() },
        growth: if wanted("growth") { stability::run_growth(settings, &begin) } else { Vec::new() },
        fuzz: if wanted("fuzz") {
            stability::fuzz::run(settings, arguments.inputs, &[command_line::target()], &begin)
        } else {
            Vec::new()
        },
    }
}

fn check(ids: &[String]) -> Result<()> {
    let known = [stability::case_ids(), PARTS.to_vec()].concat();
    match ids.iter().find(|id| !known.contains(&id.as_str())) {
        None => Ok(()),
        Some(id) => anyhow::bail!("there is no case {id:?}; there are {}", known.join(", ")),
    }
}

/// The folder of a file.
fn folder(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."))
}

fn prepare(dir: &Path) -> Result<()> {
    output::prepare(dir)?;
    output::prepare(&dir.join("figures"))
}

fn write(page: &Path, text: &str, results: &Results) -> Result<()> {
    for (name, svg) in curves::figures(results)? {
        output::write(&folder(page).join("figures").join(name), svg.as_bytes())?;
    }
    output::write(page, text.as_bytes())
}
