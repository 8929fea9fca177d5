//! `cargo xtask bench`.

use std::process::ExitCode;

use anyhow::Result;
use clap::Args;

use crate::program::{self, Rest};

/// Arguments of `cargo xtask bench`.
#[derive(Args)]
pub struct Bench {
    /// Time against dimension instead: the fixed point against Newton's method on spin chains up to
    /// D = 300.
    #[arg(long)]
    dimension: bool,
    #[command(flatten)]
    rest: Rest,
}

/// Runs the measurements.
pub fn run(arguments: &Bench) -> Result<ExitCode> {
    if arguments.dimension {
        program::run(&["--features", "dimension"], "dimension", &arguments.rest)
    } else {
        program::run(&[], "bench", &arguments.rest)
    }
}
