//! `cargo xtask work-precision`: speed against error.

mod curves;
mod page;
mod words;

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Result;
use clap::Args;
use report::{Bars, Page, files, provenance};
use verify::{Mode, Settings};

/// Arguments of `cargo xtask work-precision`.
#[derive(Args)]
pub struct WorkPrecision {
    /// Fewer steps, paths and repetitions: seconds instead of minutes, and times that mean little.
    #[arg(long)]
    quick: bool,
    /// Measure only this case; may be given several times.
    #[arg(long, value_name = "ID")]
    only: Vec<String>,
    /// Master seed, 0 to 2^64 − 1; the same seed gives the same errors. Times are what they are.
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    seed: u64,
    /// Folder for work-precision.json, the page and its figures; created if it does not exist.
    #[arg(long, value_name = "DIR", default_value = "target/work-precision")]
    out: PathBuf,
    /// Write the page here, too, with its figures in the folder `figures` beside it.
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
}

/// Measures, and writes JSON, figures and page.
pub fn run(arguments: &WorkPrecision) -> Result<ExitCode> {
    precision::check_ids(&arguments.only)?;
    let first = arguments.out.join("work-precision.md");
    let pages = || [Some(&first), arguments.page.as_ref()].into_iter().flatten();
    pages().try_for_each(|file| files::prepare_file(file))?;
    let start = Instant::now();
    let bars = Bars::new();
    let mode = if arguments.quick { Mode::Quick } else { Mode::Paper };
    let settings = Settings { seed: arguments.seed, mode };
    let mut measured = precision::measure(settings, &arguments.only, &bars)?;
    bars.finish();
    measured.provenance.threads = rayon::current_num_threads();
    measured.provenance = provenance::complete(measured.provenance, "cargo xtask", start);
    files::write_json(&arguments.out.join("work-precision.json"), &measured)?;
    let page = page::page(&measured);
    pages().try_for_each(|file| page.write(file))?;
    let mut conclusions = Page::new("Conclusions");
    page::conclusions(&mut conclusions, &measured.cases);
    println!("{}", conclusions.text());
    println!("{:.0} s; page: {}", measured.provenance.wall_s, first.display());
    Ok(ExitCode::SUCCESS)
}
