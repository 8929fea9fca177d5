//! `cargo xtask work-precision`: speed against error.

mod curves;
mod page;
mod words;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Context, Result};
use clap::Args;
use precision::results::Measurements;
use verify::{Mode, Settings};

pub use words::number;

use crate::progress::Bars;
use crate::{output, provenance};

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

/// A file of figures and its content.
struct Figure {
    name: String,
    svg: String,
}

/// Measures, and writes JSON, figures and page.
pub fn run(arguments: &WorkPrecision) -> Result<ExitCode> {
    precision::check_ids(&arguments.only)?;
    prepare(&arguments.out)?;
    if let Some(page) = &arguments.page {
        anyhow::ensure!(!page.is_dir(), "{} is a folder; name a file", page.display());
        prepare(folder(page))?;
    }
    let start = Instant::now();
    let bars = Bars::new();
    let mode = if arguments.quick { Mode::Quick } else { Mode::Paper };
    let mut measured =
        precision::measure(Settings { seed: arguments.seed, mode }, &arguments.only, &bars)?;
    bars.finish();
    let provenance = &mut measured.provenance;
    provenance.git = provenance::git();
    provenance.rustc = provenance::rustc();
    provenance.cpu = provenance::cpu();
    provenance.simd = provenance::simd();
    provenance.threads = rayon::current_num_threads();
    provenance.command = command_line();
    provenance.wall_s = start.elapsed().as_secs_f64();

    let mut json = serde_json::to_vec_pretty(&measured)?;
    json.push(b'\n');
    output::write(&arguments.out.join("work-precision.json"), &json)?;
    let figures = figures(&measured)?;
    let text = page::page(&measured);
    write(&arguments.out.join("work-precision.md"), &text, &figures)?;
    if let Some(page) = &arguments.page {
        write(page, &text, &figures)
            .context("everything is measured, but the second page cannot be written")?;
    }
    for case in &measured.cases {
        println!("{}", words::conclusion(case));
    }
    println!(
        "{:.0} s; page: {}",
        provenance_seconds(&measured),
        arguments.out.join("work-precision.md").display()
    );
    Ok(ExitCode::SUCCESS)
}

fn provenance_seconds(measured: &Measurements) -> f64 {
    measured.provenance.wall_s
}

/// The command as a user would type it, without the folders, which say nothing about the numbers.
pub fn command_line() -> String {
    let mut words = Vec::new();
    let mut arguments = std::env::args().skip(1);
    while let Some(word) = arguments.next() {
        match word.as_str() {
            "--out" | "--page" => drop(arguments.next()),
            word if word.starts_with("--out=") || word.starts_with("--page=") => {}
            word => words.push(word.to_owned()),
        }
    }
    format!("cargo xtask {}", words.join(" "))
}

/// The folder of a file.
fn folder(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."))
}

fn prepare(dir: &Path) -> Result<()> {
    output::prepare(dir)?;
    output::prepare(&dir.join("figures"))
}

fn write(page: &Path, text: &str, figures: &[Figure]) -> Result<()> {
    for figure in figures {
        output::write(&folder(page).join("figures").join(&figure.name), figure.svg.as_bytes())?;
    }
    output::write(page, text.as_bytes())
}

/// Two figures for every case.
fn figures(measured: &Measurements) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for case in &measured.cases {
        let (strong, weak) = (curves::strong_figure(case)?, curves::weak_figure(case)?);
        figures.push(Figure { name: page::figure_name(case, "strong"), svg: strong });
        figures.push(Figure { name: page::figure_name(case, "weak"), svg: weak });
    }
    Ok(figures)
}
