//! The program `casimir`: a scene in a text file, one command, a picture.

mod arguments;
mod commands;
mod failure;
mod output;

use std::process::ExitCode;

use casimir_cli::{model, scene};
use clap::Parser;

use arguments::{Arguments, Command};

fn main() -> ExitCode {
    let done = match Arguments::parse().command {
        Command::New(arguments) => commands::new(&arguments),
        Command::Inspect(arguments) => commands::inspect(&arguments),
        Command::Run(arguments) => commands::run(&arguments),
        Command::Expect(arguments) => commands::expect(&arguments),
        Command::Order(arguments) => commands::order(&arguments),
        Command::Compare(arguments) => commands::compare(&arguments),
        Command::Plan(arguments) => commands::plan(&arguments),
        Command::Part(arguments) => commands::part(&arguments),
        Command::Merge(arguments) => commands::merge(&arguments),
        Command::Extend(arguments) => commands::extend(&arguments),
        Command::Schema => commands::schema(),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
