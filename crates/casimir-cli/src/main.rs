//! The program `casimir`: a scene in a text file, one command, a picture.

mod arguments;
mod commands;

use std::process::ExitCode;

use clap::Parser;
use verbs::failure::{Done, Failure};

use arguments::{Arguments, Command};

fn main() -> ExitCode {
    let Arguments { citation, command } = Arguments::parse();
    commands::handle_signals();
    let cited = || commands::citation(citation.flatten().as_deref());
    let done = command.map_or_else(cited, run);
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

fn run(command: Command) -> Done {
    use Command::*;
    match command {
        New { name, list } => commands::new(name.as_deref(), list),
        Inspect(asked) => commands::inspect(&asked),
        Run(asked) => commands::run(&asked),
        Expect(asked) => commands::expect(&asked),
        Equilibrium(asked) => commands::equilibrium(&asked),
        Lyapunov(asked) => commands::lyapunov(&asked),
        Order(asked) => commands::order(&asked),
        Compare(asked) => commands::compare(&asked),
        Plan(asked) => commands::plan(&asked),
        Part { folder, part, threads } => commands::part(&folder, part, threads),
        Merge { folder, write, json } => commands::merge(&folder, &write, json),
        Extend { folder, paths } => commands::extend(&folder, paths),
        Schema => commands::schema(),
        Doctor => commands::doctor(),
    }
}
