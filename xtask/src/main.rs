//! Chores of the workspace.
//!
//! `cargo xtask reproduce` runs the experiments of the paper, prints a verdict for every statement
//! and writes a report with figures, tables and `results.json`. `cargo xtask verify` runs the
//! battery for many seeds; `cargo xtask work-precision` measures errors against processor time,
//! `cargo xtask bench` speed; `cargo xtask stability` runs hard cases and fuzzes.

mod battery;
mod bench;
mod budget;
mod program;
mod reproduce;
mod verify;
mod wording;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Chores of the workspace.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    chore: Chore,
}

#[derive(Subcommand)]
enum Chore {
    /// Run the paper's experiments, print the verdicts and write the report.
    Reproduce(reproduce::Reproduce),
    /// Run the whole battery for many seeds, with all wrong twins, and write docs/verification.md.
    Verify(verify::Verify),
    /// Measure the errors of every scheme against the processor time they take.
    #[command(disable_help_flag = true)]
    WorkPrecision(program::Rest),
    /// Measure what a path-step costs: every scheme on every system, threads, memory, growth,
    /// dimension.
    #[command(disable_help_flag = true)]
    Bench(bench::Bench),
    /// Run the hard cases, the long runs and the fuzzer, and report what is guaranteed.
    #[command(disable_help_flag = true)]
    Stability(program::Rest),
}

fn main() -> ExitCode {
    let result = match Arguments::parse().chore {
        Chore::Reproduce(arguments) => reproduce::run(&arguments),
        Chore::Verify(arguments) => verify::run(&arguments),
        Chore::WorkPrecision(arguments) => program::run(&[], "work-precision", &arguments),
        Chore::Bench(arguments) => bench::run(&arguments),
        Chore::Stability(arguments) => program::run(&[], "hard-cases", &arguments),
    };
    result.unwrap_or_else(|error| {
        eprintln!("error: {error:#}");
        ExitCode::from(2)
    })
}
