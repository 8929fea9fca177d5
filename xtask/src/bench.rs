//! `cargo xtask bench`: builds and runs the crate `speed`, and adds to its numbers where they come
//! from.
//!
//! A process of its own and not a library here: every scheme on every system takes longer to
//! compile than all of the report, for which nobody who wants the report should wait.

use std::env;
use std::path::PathBuf;
use std::process::{Command, ExitCode};
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use clap::Args;
use report::{files, provenance};
use serde_json::{Value, json};
use verify::results::Provenance;

/// Arguments of `cargo xtask bench`.
#[derive(Args)]
pub struct Bench {
    /// Write the numbers to this file, with where they come from.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Time against dimension instead: the fixed point against Newton's method on spin chains up to
    /// D = 300.
    #[arg(long, conflicts_with = "json")]
    dimension: bool,
    /// What else the measuring program takes: --quick, --repetitions N, --simd LEVEL.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    rest: Vec<String>,
}

/// Runs the measurements.
pub fn run(arguments: &Bench) -> Result<ExitCode> {
    arguments.json.as_deref().map_or(Ok(()), files::prepare_file)?;
    let scratch = tempfile::tempdir().context("cannot create a folder for the numbers")?;
    let numbers = scratch.path().join("speed.json");
    let start = Instant::now();
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(["run", "--quiet", "--release", "--package", "speed"]);
    if arguments.dimension {
        command.args(["--features", "dimension", "--bin", "dimension", "--"]);
    } else {
        command.args(["--bin", "speed", "--", "--json"]).arg(&numbers);
    }
    let status = command.args(&arguments.rest).status().context("cannot run cargo")?;
    ensure!(status.success(), "the measurement failed: {status}");
    if let Some(file) = &arguments.json {
        let text = std::fs::read(&numbers).context("the measurement left no numbers")?;
        let numbers = serde_json::from_slice(&text)?;
        let from = provenance::complete(Provenance::default(), "cargo xtask", start);
        files::write_json(file, &with_provenance(numbers, &from))?;
        println!("numbers: {}", file.display());
    }
    Ok(ExitCode::SUCCESS)
}

/// The numbers under `speed`, and where they come from.
fn with_provenance(speed: Value, from: &Provenance) -> Value {
    let Provenance { git, rustc, cpu, command, wall_s, .. } = from;
    let from =
        json!({ "git": git, "rustc": rustc, "cpu": cpu, "command": command, "wall_s": wall_s });
    json!({ "schema": 1, "provenance": from, "speed": speed })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_digits_and_say_where_they_come_from() {
        let speed = json!({ "peak_memory_mb": 0.1, "schemes": [] });
        let from = Provenance { wall_s: 2.5, cpu: "a cpu".to_owned(), ..Provenance::default() };
        let report = with_provenance(speed.clone(), &from);
        assert_eq!(report["speed"], speed);
        assert_eq!(report["provenance"]["wall_s"], 2.5);
        assert_eq!(report["provenance"]["cpu"], "a cpu");
    }
}
