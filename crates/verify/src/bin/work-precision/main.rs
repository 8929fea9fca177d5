//! `cargo xtask work-precision`: which scheme is cheapest for which error.
//!
//! For each of the paper's systems and each scheme, errors at several step sizes are measured on a
//! ladder, untimed and the same bits on any machine; then the processor time of a path at each step
//! size, on one thread. `docs/work-precision.md` is made from them.

mod conclusions;
mod measure;
mod page;
mod results;
mod sizes;

use std::{path::PathBuf, process::ExitCode, time::Instant};

use analysis::{Mode, Settings, Stopwatch, results::Provenance};
use anyhow::Result;
use clap::Parser;
use report::{Bars, files, provenance};
use results::Measurements;
use verify::{command, setups};

/// Measures the errors of every scheme against the processor time they take.
#[derive(Parser)]
#[command(name = "cargo xtask work-precision", version)]
struct Arguments {
    /// Fewer steps, paths and repetitions: seconds instead of minutes, and times that mean little.
    #[arg(long)]
    quick: bool,
    /// Measure only this case; may be given several times.
    #[arg(long, value_name = "ID", value_parser = setups::PAPER)]
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

fn main() -> ExitCode {
    command::exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<ExitCode> {
    files::prepare(&arguments.out.join("figures"))?;
    if let Some(page) = &arguments.page {
        files::prepare_file(page)?;
    }
    let (start, bars) = (Instant::now(), Bars::default());
    let mode = if arguments.quick { Mode::Quick } else { Mode::Paper };
    let settings = Settings::new(arguments.seed, mode);
    let cases = measure::measure(settings, &arguments.only, &bars)?;
    bars.finish();
    let measured = Measurements {
        schema: results::SCHEMA,
        provenance: provenance::complete(
            Provenance::of_run(arguments.seed, mode.id()),
            "cargo xtask work-precision",
            start,
        ),
        clock: if Stopwatch::MEASURES_PROCESSOR {
            "processor time of the thread"
        } else {
            "wall time: this system does not measure the processor time of a thread"
        },
        cases,
    };
    files::write_json(&arguments.out.join("work-precision.json"), &measured)?;
    let page = page::page(&measured);
    let file = arguments.out.join("work-precision.md");
    for file in [&file].into_iter().chain(&arguments.page) {
        page.write(file)?;
    }
    for case in &measured.cases {
        println!("{}: {}", case.id, conclusions::strong(case));
    }
    println!("{:.0} s; page: {}", measured.provenance.wall_s, file.display());
    Ok(ExitCode::SUCCESS)
}
