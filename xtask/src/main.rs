//! Chores of the workspace: programs of the packages `lab` and `battery`, built and run here.
//!
//! `cargo xtask CHORE ARGUMENTS…` is `cargo run --release -p PACKAGE --bin PROGRAM --
//! ARGUMENTS…`, so a chore builds what it needs and nothing else.

use std::{
    env,
    ffi::OsString,
    process::{Command, ExitCode},
};

/// A chore, the package and the program that do it, what else cargo is told, and what it is for.
type Chore = (&'static str, [&'static str; 2], &'static [&'static str], &'static str);

/// The feature without which the programs that measure are not built.
const MEASURING: &[&str] = &["--features", "measuring"];

const CHORES: [Chore; 6] = [
    ("reproduce", ["lab", "reproduce"], &[], "Run the paper's experiments and write the report"),
    (
        "verify",
        ["battery", "battery"],
        MEASURING,
        "Run all checks for many seeds and write docs/verification.md",
    ),
    (
        "work-precision",
        ["lab", "work-precision"],
        MEASURING,
        "Measure errors against processor time",
    ),
    (
        "stability",
        ["lab", "hard-cases"],
        MEASURING,
        "Run the hard cases, the long runs and the fuzzer",
    ),
    ("bench", ["lab", "bench"], MEASURING, "Measure what a path-step costs"),
    (
        "dimension",
        ["lab", "dimension"],
        &["--features", "dimension"],
        "Measure the fixed point against Newton's method up to D = 300",
    ),
];

fn main() -> ExitCode {
    let mut arguments = env::args_os().skip(1);
    let name = arguments.next().unwrap_or_default();
    if ["", "help", "-h", "--help"].iter().any(|help| name == *help) {
        print!("{}", help());
        return ExitCode::SUCCESS;
    }
    let Some((_, [package, program], options, _)) = CHORES.iter().find(|chore| name == chore.0)
    else {
        eprint!("error: there is no chore {name:?}\n\n{}", help());
        return ExitCode::from(2);
    };
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo)
        .args(["run", "--quiet", "--release", "--package", package, "--bin", program])
        .args(*options)
        .arg("--")
        .args(arguments.collect::<Vec<OsString>>())
        .status();
    match status {
        Ok(status) => {
            let code = status.code().and_then(|code| u8::try_from(code).ok());
            code.map_or(ExitCode::FAILURE, ExitCode::from)
        }
        Err(error) => {
            eprintln!("error: cannot run cargo: {error}");
            ExitCode::from(2)
        }
    }
}

fn help() -> String {
    let chores = CHORES.map(|(name, _, _, about)| format!("  {name:16}{about}\n"));
    format!(
        "Usage: cargo xtask CHORE [ARGUMENTS]\n\n{}\n`cargo xtask CHORE --help` lists its \
         arguments.\n",
        chores.concat()
    )
}
