//! **The program `casimir`: a scene in a text file, one command, a picture.**
//!
//! [`run`] is all of it: the binary calls it, and so does the Python package.

mod arguments;
mod commands;

use std::{ffi::OsString, path::PathBuf};

use clap::Parser;
use verbs::failure::Failure;

use arguments::Arguments;
pub use commands::card;

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
    commands::handle_signals();
    let done = match command {
        Some(command) => command.run(&program),
        None => commands::citation(citation.flatten().as_deref()),
    };
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
