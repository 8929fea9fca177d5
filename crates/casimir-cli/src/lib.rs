//! **The program `casimir`: a scene in a text file, one command, a picture.**
//!
//! [`run`] is all of it: the binary calls it, and so does the Python package.

mod arguments;
mod commands;

use std::{ffi::OsString, path::PathBuf, sync::OnceLock};

use clap::Parser;
use verbs::failure::Failure;

use arguments::{Arguments, Command};
pub use commands::card;

/// The program that job scripts start.
static PROGRAM: OnceLock<PathBuf> = OnceLock::new();

/// Runs the command line `arguments`, which begin with a name of the program, and returns the exit
/// code; `program` is the file that job scripts start.
pub fn run(program: PathBuf, arguments: Vec<OsString>) -> u8 {
    let Arguments { citation, command } = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => {
            _ = error.print();
            return error.exit_code() as u8;
        }
    };
    _ = PROGRAM.set(program);
    commands::handle_signals();
    let cited = || commands::citation(citation.flatten().as_deref());
    let done = command.map_or_else(cited, Command::run);
    commands::left_to_processor();
    let (code, kind, words) = match done {
        Ok(()) => return 0,
        Err(Failure::Scene(error)) => (2, "error", error.to_string()),
        Err(Failure::Usage(words)) => (2, "error", words),
        Err(Failure::Run(words)) => (1, "error", words),
        Err(Failure::Stopped(words)) => (130, "stopped", words),
    };
    eprintln!("{kind}: {words}");
    code
}
