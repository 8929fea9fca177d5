//! Chores of the workspace: programs of the packages `casimir-verify` and `battery`, built and run here.
//!
//! `cargo xtask CHORE ARGUMENTS…` is `cargo run --release -p PACKAGE --bin PROGRAM --
//! ARGUMENTS…`, so a chore builds what it needs and nothing else.
//!
//! `cargo xtask plan CHORE ARGUMENTS…` is the chore with `--plan`, and `cargo xtask merge DIR` the
//! one that `DIR/run.json` names, with its arguments and `--merge`.

use std::{
    env,
    ffi::OsString,
    fs,
    path::Path,
    process::{Command, ExitCode},
};

use serde_json::Value;

/// A chore, the package and the program that do it, what else cargo is told, and what it is for.
type Chore = (&'static str, [&'static str; 2], &'static [&'static str], &'static str);

/// The feature without which the programs that measure are not built.
const MEASURING: &[&str] = &["--features", "measuring"];

const CHORES: [Chore; 5] = [
    (
        "reproduce",
        ["casimir-verify", "reproduce"],
        &[],
        "Run the paper's experiments and write the report",
    ),
    (
        "verify",
        ["battery", "battery"],
        MEASURING,
        "Run all checks for many seeds and write docs/verification.md",
    ),
    (
        "work-precision",
        ["casimir-verify", "work-precision"],
        MEASURING,
        "Measure errors against processor time",
    ),
    (
        "stability",
        ["casimir-verify", "hard-cases"],
        MEASURING,
        "Run the hard cases, the long runs and the fuzzer",
    ),
    ("bench", ["casimir-verify", "bench"], MEASURING, "Measure what a path-step costs"),
];

fn main() -> ExitCode {
    let mut arguments: Vec<OsString> = env::args_os().skip(1).collect();
    if arguments.first().is_none_or(|name| ["help", "-h", "--help"].iter().any(|help| name == help))
    {
        print!("{}", help());
        return ExitCode::SUCCESS;
    }
    let mut name = arguments.remove(0);
    if name == "plan" && !arguments.is_empty() {
        name = arguments.remove(0);
        arguments.push("--plan".into());
    } else if name == "merge" {
        match merge(arguments) {
            Ok(chore) => (name, arguments) = chore,
            Err(error) => {
                eprintln!("error: {error}");
                return ExitCode::from(2);
            }
        }
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
        .args(arguments)
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

/// The chore and the arguments that merge the parts in a folder, the first of these.
fn merge(mut arguments: Vec<OsString>) -> Result<(OsString, Vec<OsString>), String> {
    if arguments.is_empty() {
        return Err("which parts? cargo xtask merge DIR".into());
    }
    let folder = arguments.remove(0);
    let file = Path::new(&folder).join("run.json");
    let file_error = |error: &dyn std::fmt::Display| {
        format!("{} does not say what its parts are: {error}", file.display())
    };
    let text = fs::read(&file).map_err(|error| file_error(&error))?;
    let run: Value = serde_json::from_slice(&text).map_err(|error| file_error(&error))?;
    let [program, list, sizes] = ["program", "arguments", "sizes"].map(|key| &run[key]);
    let (Some(program), Some(list), Some(sizes)) =
        (program.as_str(), list.as_array(), sizes.as_object())
    else {
        return Err(file_error(&"it is damaged"));
    };
    // 20 and not 20.0, which is no number of seeds.
    let number = |size: &Value| size.as_f64().unwrap_or(f64::NAN).to_string();
    let sizes = sizes.iter().flat_map(|(name, size)| [name.clone(), number(size)]);
    let words = list.iter().filter_map(Value::as_str).map(str::to_owned).chain(sizes);
    let mut all: Vec<OsString> = words.map(OsString::from).collect();
    all.extend(["--merge".into(), "--out".into(), folder]);
    all.append(&mut arguments);
    Ok((program.into(), all))
}

fn help() -> String {
    let chores = CHORES.map(|(name, _, _, about)| format!("  {name:16}{about}\n"));
    format!(
        "Usage: cargo xtask CHORE [ARGUMENTS]\n\n{}\nStudies on many machines, of `reproduce` and \
         `verify`:\n  plan CHORE      Say what --parts N take, and write the job script into --out \
         DIR\n  merge DIR       Make the results of the parts in a folder\n\n`cargo xtask CHORE \
         --help` lists its arguments.\n",
        chores.concat()
    )
}
