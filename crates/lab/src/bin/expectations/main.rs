//! `cargo xtask expectations`: what an expectation costs, how large the bias of a scheme is, and
//! the weak order of `nv`.
//!
//! The problem is the rigid body with three noises, whose expectations are known without sampling;
//! orders are measured on two others as well. All times are those of one thread.
//! `docs/expectations.md` is made from them.

mod bias;
mod cost;
mod line;
mod one_level;
mod order;
mod page;
mod results;
mod scrambles;

use std::{fs, path::PathBuf, process::ExitCode, time::Instant};

use anyhow::Result;
use clap::Parser;
use lab::command;
use rayon::ThreadPoolBuilder;
use report::{files, provenance};
use results::Measurements;
use verify::{Mode, Stopwatch, results::Provenance};

/// Measures what an expectation costs by several methods, the bias of every scheme, and the weak
/// order of nv.
#[derive(Parser)]
#[command(name = "cargo xtask expectations", version)]
struct Arguments {
    /// Lower accuracies and fewer points: seconds instead of minutes, and times that mean little.
    #[arg(long)]
    quick: bool,
    /// Master seed, 0 to 2^64 − 1; the same seed gives the same estimates. Times are what they are.
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    seed: u64,
    /// Folder for expectations.json, the page and its figures; created if it does not exist.
    #[arg(long, value_name = "DIR", default_value = "target/expectations")]
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
    let (start, load) = (Instant::now(), load());
    let mode = if arguments.quick { Mode::Quick } else { Mode::Paper };
    // On the one thread of this pool, whose processor time is that of all the work.
    let pool = ThreadPoolBuilder::new().num_threads(1).build()?;
    let (methods, twelve, threads) = pool.install(|| -> Result<_> {
        let (methods, twelve) = cost::measure(arguments.seed, arguments.quick)?;
        Ok((methods, twelve, Provenance::of_run(arguments.seed, mode.id())))
    })?;
    // No times: on all threads.
    let bias = bias::measure(arguments.seed, arguments.quick)?;
    let orders = order::measure(arguments.seed, arguments.quick)?;
    let measured = Measurements {
        schema: results::SCHEMA,
        provenance: provenance::complete(threads, "cargo xtask expectations", start),
        clock: if Stopwatch::MEASURES_PROCESSOR {
            "processor time of the thread"
        } else {
            "wall time: this system does not measure the processor time of a thread"
        },
        load,
        methods,
        twelve,
        bias,
        orders,
    };
    files::write_json(&arguments.out.join("expectations.json"), &measured)?;
    let page = page::page(&measured);
    let file = arguments.out.join("expectations.md");
    for file in [&file].into_iter().chain(&arguments.page) {
        page.write(file)?;
    }
    for method in &measured.methods {
        let last = method.rows.last();
        let steps = last.map_or(0.0, |row| row.path_steps as f64);
        println!("{}: {} path-steps for the last row", method.name, report::number(steps));
    }
    println!("{:.0} s; page: {}", measured.provenance.wall_s, file.display());
    Ok(ExitCode::SUCCESS)
}

/// How many processes wanted to run in the minute before the start, where the system tells.
fn load() -> Option<f64> {
    fs::read_to_string("/proc/loadavg").ok()?.split_whitespace().next()?.parse().ok()
}
