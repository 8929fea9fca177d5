//! The command line of the workspace: `cargo xtask CHORE ARGUMENTS…` is an alias of a cargo
//! command.

use std::{
    env,
    process::{Command, ExitCode},
};

/// A chore, the cargo command that does it, and what it is for.
const CHORES: [(&str, &str, &str); 4] = [
    (
        "reproduce",
        "run --release --bin reproduce --",
        "Run the paper's experiments and write the report",
    ),
    (
        "verify",
        "test --release --test known_answers -- --include-ignored --nocapture --test-threads 1",
        "Ask for known answers with many seeds, and print the tables",
    ),
    (
        "stability",
        "test --release --test measuring -- --nocapture --test-threads 1 hard_cases",
        "Run every scheme on hard inputs",
    ),
    ("bench", "bench --bench speed --", "Measure what a path-step costs"),
];

fn main() -> ExitCode {
    let mut arguments = env::args_os().skip(1);
    let name = arguments.next().unwrap_or_default();
    let Some((_, command, _)) = CHORES.iter().find(|chore| name == chore.0) else {
        let chores = CHORES.map(|(name, _, about)| format!("  {name:16}{about}\n")).concat();
        println!("Usage: cargo xtask CHORE [ARGUMENTS]\n\n{chores}");
        let asked = ["", "help", "-h", "--help"].iter().any(|help| name == *help);
        return ExitCode::from(if asked { 0 } else { 2 });
    };
    let mut words = command.split_whitespace();
    let commit = Command::new("git")
        .args(["-C", env!("CARGO_MANIFEST_DIR"), "describe", "--always", "--dirty"])
        .args(["--abbrev=12", "--exclude=*"])
        .output()
        .ok()
        .filter(|output| output.status.success())
        .map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned());
    let status = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .args(words.next())
        .args(["--quiet", "--package", "casimir-verify"])
        .args(words)
        .envs(commit.map(|commit| ("CASIMIR_COMMIT", commit)))
        .args(arguments)
        .status();
    let code = status.ok().and_then(|status| u8::try_from(status.code()?).ok());
    code.map_or(ExitCode::FAILURE, ExitCode::from)
}
