//! The program `casimir`.

use std::{env, process::ExitCode};

fn main() -> ExitCode {
    let program = env::current_exe().unwrap_or_else(|_| "casimir".into());
    ExitCode::from(casimir_cli::run(program, env::args_os().collect()))
}
