//! The program `casimir`: a scene in a text file, one command, a picture.

mod arguments;
mod commands;

use std::process::ExitCode;

use clap::Parser;
use verbs::failure::Failure;

use arguments::{Arguments, Command};

fn main() -> ExitCode {
    let Arguments { citation, command } = Arguments::parse();
    commands::handle_signals();
    let cited = || commands::citation(citation.flatten().as_deref());
    let done = command.map_or_else(cited, Command::run);
    let (code, kind, words) = match done {
        Ok(()) => return ExitCode::SUCCESS,
        Err(Failure::Scene(error)) => (2, "error", error.to_string()),
        Err(Failure::Usage(words)) => (2, "error", words),
        Err(Failure::Run(words)) => (1, "error", words),
        Err(Failure::Stopped(words)) => (130, "stopped", words),
    };
    eprintln!("{kind}: {words}");
    ExitCode::from(code)
}
