//! The program `casimir`: a scene in a text file, one command, a picture.

mod arguments;
mod commands;

use std::process::ExitCode;

use casimir_cli::failure::{Done, Failure};
use clap::Parser;

use arguments::{Arguments, Command};

fn main() -> ExitCode {
    let Arguments { citation, command } = Arguments::parse();
    let cited = || commands::citation(citation.flatten().as_deref());
    let done = command.map_or_else(cited, run);
    let (code, words) = match done {
        Ok(()) => return ExitCode::SUCCESS,
        Err(Failure::Scene(error)) => (2, format!("error: {error}")),
        Err(Failure::Usage(words)) => (2, format!("error: {words}")),
        Err(Failure::Run(words)) => (1, format!("error: {words}")),
        Err(Failure::Stopped(words)) => (130, format!("stopped: {words}")),
    };
    eprintln!("{words}");
    ExitCode::from(code)
}

fn run(command: Command) -> Done {
    match command {
        Command::New(arguments) => commands::new(&arguments),
        Command::Inspect(arguments) => commands::inspect(&arguments),
        Command::Run(arguments) => commands::run(&arguments),
        Command::Expect(arguments) => commands::expect(&arguments),
        Command::Equilibrium(arguments) => commands::equilibrium(&arguments),
        Command::Lyapunov(arguments) => commands::lyapunov(&arguments),
        Command::Order(arguments) => commands::order(&arguments),
        Command::Compare(arguments) => commands::compare(&arguments),
        Command::Plan(arguments) => commands::plan(&arguments),
        Command::Part(arguments) => commands::part(&arguments),
        Command::Merge(arguments) => commands::merge(&arguments),
        Command::Extend(arguments) => commands::extend(&arguments),
        Command::Schema => commands::schema(),
        Command::Doctor => commands::doctor(),
    }
}
