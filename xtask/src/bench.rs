//! `cargo xtask bench`: builds and runs the crate `speed`, and adds to its numbers where they come
//! from.
//!
//! A process of its own and not a library here: every scheme on every system takes longer to
//! compile than all of the report, for which nobody who wants the report should wait.

use std::env;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use clap::Args;
use serde_json::{Value, json};

use crate::{output, provenance};

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
    let folder = arguments.json.as_deref().map(parent);
    if let Some(folder) = folder {
        output::prepare(folder)?;
    }
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
        let report = with_provenance(serde_json::from_slice(&text)?, start.elapsed().as_secs_f64());
        let mut json = serde_json::to_vec_pretty(&report)?;
        json.push(b'\n');
        output::write(file, &json)?;
        println!("numbers: {}", file.display());
    }
    Ok(ExitCode::SUCCESS)
}

/// The folder of a file.
fn parent(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."))
}

/// The numbers under `speed`, and where they come from.
fn with_provenance(speed: Value, wall_s: f64) -> Value {
    let arguments: Vec<String> = env::args().skip(1).collect();
    json!({
        "schema": 1,
        "provenance": {
            "git": provenance::git(),
            "rustc": provenance::rustc(),
            "cpu": provenance::cpu(),
            "command": format!("cargo xtask {}", arguments.join(" ")),
            "wall_s": wall_s,
        },
        "speed": speed,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_digits_and_say_where_they_come_from() {
        let speed = json!({ "peak_memory_mb": 0.1, "schemes": [] });
        let report = with_provenance(speed.clone(), 2.5);
        assert_eq!(report["speed"], speed);
        assert_eq!(report["provenance"]["wall_s"], 2.5);
        for key in ["git", "rustc", "cpu", "command"] {
            assert!(
                report["provenance"][key].as_str().is_some_and(|text| !text.is_empty()),
                "{key}"
            );
        }
    }

    #[test]
    fn a_bare_name_is_in_the_current_folder() {
        assert_eq!(parent(Path::new("speed.json")), Path::new("."));
        assert_eq!(parent(Path::new("a/speed.json")), Path::new("a"));
    }
}
