//! The page docs/table.md: what every command does with every kind of system, by running it.
//!
//! `WRITE=1` writes the page.

use std::{
    env, fs,
    path::Path,
    process::{Command, Output, Stdio},
    thread::sleep,
    time::Duration,
};

use rayon::prelude::*;
use serde_json::Value;

use crate::common::{casimir, run, with_scene};

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/table.md");

/// Kinds of systems: title, tables up to that of the initial value, an observable with a mean, and
/// a parameter.
const KINDS: [(&str, &str, &str, &str); 8] = [
    (
        "built-in",
        "[system]\nname = \"pendulum\"\nparameters = { c = 0.3 }\n[run]\ninitial = [1, 0]",
        "y1",
        "c",
    ),
    (
        "formulas",
        "[system]\nstate = [\"y1\", \"y2\"]\nB = \"canonical\"\nH0 = \"w*(y1^2 + y2^2)/2\"\n\
         H = [\"0.3*y1\"]\nparameters = { w = 1 }\n[run]\ninitial = [1, 0]",
        "y1",
        "w",
    ),
    (
        "a bath",
        "[system]\nstate = [\"y1\", \"y2\"]\nB = \"canonical\"\nH0 = \"y2^2/2 + k*y1^4/4\"\n\
         parameters = { k = 1 }\n[bath]\ntemperature = 1\nfriction = { y2 = 1 }\n[run]\n\
         initial = [1, 0]",
        "y1",
        "k",
    ),
    (
        "friction by components",
        "[system]\nstate = [\"y1\", \"y2\"]\nB = \"canonical\"\nH0 = \"w*(y1^2 + y2^2)/2\"\n\
         H = [\"0.3*y1\"]\nparameters = { w = 1 }\n[damping]\nrates = { y2 = 0.5 }\n[run]\n\
         initial = [1, 0]",
        "y1",
        "w",
    ),
    (
        "Hamiltonians of time",
        "[system]\nstate = [\"y1\", \"y2\"]\nB = \"canonical\"\n\
         H0 = \"w*(y1^2 + y2^2)/2 - cos(t)*y1\"\nH = [\"0.3*y1\"]\nparameters = { w = 1 }\n[run]\n\
         initial = [1, 0]",
        "y1",
        "w",
    ),
    (
        "drift and noise",
        "[system]\nstate = [\"y1\", \"y2\"]\ndrift = [\"y2\", \"-w*y1 - y2\"]\n\
         noise = [[\"0\", \"0.3\"]]\nparameters = { w = 1 }\n[run]\ninitial = [1, 0]",
        "y1",
        "w",
    ),
    (
        "a lattice",
        "[system]\nname = \"spin-lattice\"\nparameters = { sizes = [3], exchange = 0.7, anisotropy = 0.5 }\n[bath]\n\
         temperature = 0.5\ntransverse = { s = 0.1 }\n[run]\ninitial = [0.6, 0, 0.8]",
        "mx",
        "anisotropy",
    ),
    (
        "matrices",
        "[system]\nname = \"quantum\"\n[system.parameters]\ng = 0.8\n\
         hamiltonian = [0, \"-i\", \"i\", 0]\nnoises = [\"g/2\", 0, 0, \"-g/2\"]\n[run]\n\
         initial = [1, 0]",
        "p1",
        "g",
    ),
];

/// Commands with the options that make them short.
const COMMANDS: [(&str, &str); 8] = [
    ("run", "--paths 100"),
    ("expect", "--accuracy 1e3"),
    ("equilibrium", "--accuracy 1e3 --chains 32 --path-steps 1e5"),
    ("lyapunov", "--accuracy 1e3 --chains 32 --path-steps 1e5"),
    ("order", "--path-steps 1e5"),
    ("compare", "--error 0.1 --budget 0.5"),
    ("inspect", ""),
    ("fit", "data.csv"),
];

/// A table of a mean at the end, for `fit`.
fn data(observable: &str, error: f64) -> String {
    format!("time,observable,statistic,value,error\n1,{observable},mean,0.5,{error}\n")
}

fn scene(tables: &str, observable: &str, parameter: &str, steps: u64) -> String {
    format!(
        "{tables}\nuntil = 1\nsteps = {steps}\npaths = 1\n[expect]\nof = [\"{observable}\"]\n\
         accuracy = 1000\n[fit]\nparameters = [\"{parameter}\"]\n"
    )
}

/// Arguments of a command on `scene.toml`.
fn arguments<'a>((command, options): (&'a str, &'a str)) -> Vec<&'a str> {
    let options = options.split(' ').filter(|word| !word.is_empty());
    [command, "scene.toml", "--json", "--threads", "1"].into_iter().chain(options).collect()
}

/// The mark of a cell: that it works, or the number of the reason why it does not.
fn cell(output: &Output, reasons: &mut Vec<String>) -> String {
    let message = String::from_utf8_lossy(&output.stderr);
    match output.status.code() {
        Some(0) => {
            let json: Value = serde_json::from_slice(&output.stdout).expect("JSON");
            assert!(json.is_array() || json["warnings"].is_array(), "{json}");
            "✓".into()
        }
        // An accuracy that so few path-steps do not reach is an answer.
        Some(1) if message.contains("not reached") => "✓".into(),
        Some(1 | 2) => {
            let reason = message.lines().find(|line| line.starts_with("error: "));
            let reason = reason.unwrap_or_else(|| panic!("{message}"));
            let reason = reason.rsplit_once("scene.toml").map_or(reason, |(_, reason)| reason);
            // After the place in the file.
            let words = reason.split_once(": ").map_or(reason, |(_, words)| words).to_owned();
            let known = reasons.iter().position(|known| *known == words);
            let k = known.unwrap_or_else(|| {
                reasons.push(words);
                reasons.len() - 1
            });
            format!("{}", k + 1)
        }
        code => panic!("{code:?}: {message}"),
    }
}

/// Rows of a table in Markdown.
fn table(head: &str, columns: &[&str], rows: &[(String, Vec<String>)]) -> String {
    let mut text =
        format!("| {head} | {} |\n|{}\n", columns.join(" | "), "---|".repeat(columns.len() + 1));
    for (name, cells) in rows {
        text += &format!("| {name} | {} |\n", cells.join(" | "));
    }
    text
}

/// Ways to use a command.
const WAYS: [&str; 6] =
    ["a sweep", "`--of`", "Ctrl-C", "resumed after kill −9", "in parts", "Python"];

/// Options by which a command takes long enough to be stopped; none where nothing is kept, or the
/// answer comes in seconds.
const LONG: [&str; 8] = [
    "--paths 30000000",
    "--accuracy 1e-7 --scheme sexp",
    "--accuracy 1e-6 --scheme sexp --path-steps 1e13",
    "--accuracy 1e-7 --path-steps 1e13",
    "",
    "--error 1e-9 --budget 1000",
    "",
    "exact.csv --path-steps 1e13",
];

/// Begins a long command, ends it by a signal after some seconds, and gives its messages.
fn ended(folder: &Path, of: (&str, &str), signal: &str) -> (Option<i32>, String) {
    let child = casimir(folder)
        .args(arguments(of))
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    sleep(Duration::from_secs(8));
    let id = child.id().to_string();
    assert!(Command::new("kill").args([signal, &id]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// The cells of a command.
fn ways((command, long): (&str, &str)) -> Vec<String> {
    let (_, tables, observable, parameter) = KINDS[2];
    let folder = with_scene(&scene(tables, observable, parameter, 64));
    let path = folder.path();
    fs::write(path.join("data.csv"), data(observable, 0.5)).unwrap();
    fs::write(path.join("exact.csv"), data(observable, 1e-6)).unwrap();
    let short = COMMANDS.into_iter().find(|(name, _)| *name == command).unwrap();
    let yes = |works: bool, otherwise: &str| if works { "✓".into() } else { otherwise.into() };
    let sweep = run(path, &[&arguments(short)[..], &["--set", "k=1,2"]].concat());
    let swept = sweep.status.code().is_some_and(|code| {
        let list: Value = serde_json::from_slice(&sweep.stdout).unwrap_or_default();
        code < 2 && (list.as_array().or(list["runs"].as_array())).is_some_and(|all| all.len() == 2)
    });
    let of = run(path, &[&arguments(short)[..], &["--of", "y2"]].concat());
    let of = of.status.code().is_some_and(|code| code < 2);
    let [mut stopped, mut resumed] = [false; 2];
    if !long.is_empty() {
        let long = (command, long);
        ended(path, long, "-KILL");
        let (code, said) = ended(path, long, "-INT");
        resumed = said.contains("going on from");
        stopped = code == Some(130) && said.contains("the same command");
    }
    let python = concat!(env!("CARGO_MANIFEST_DIR"), "/../../python/casimir/_scene.py");
    let python = fs::read_to_string(python).unwrap();
    let parts = command == "run" || python.contains(&format!("verb: Literal[\"{command}\"]"));
    vec![
        yes(swept, "of one scene"),
        yes(of, "–"),
        yes(stopped, "ends in seconds"),
        yes(resumed, "ends in seconds"),
        yes(parts, "no"),
        yes(python.contains(&format!("    def {command}(")), "no"),
    ]
}

/// No cell is empty: a command works, or says why not.
#[test]
#[ignore = "long: run by the gate"]
fn the_page_says_what_works() {
    let cells: Vec<Vec<Output>> = COMMANDS
        .into_par_iter()
        .map(|of| {
            let one = |(_, tables, observable, parameter): &(&str, &str, &str, &str)| {
                let folder = with_scene(&scene(tables, observable, parameter, 16));
                fs::write(folder.path().join("data.csv"), data(observable, 0.5)).unwrap();
                let mut command = Command::new("timeout");
                command.current_dir(folder.path()).args(["100", env!("CARGO_BIN_EXE_casimir")]);
                command.args(arguments(of)).output().unwrap()
            };
            KINDS.iter().map(one).collect()
        })
        .collect();
    let mut reasons = Vec::new();
    let row = |(of, outputs): (&(&str, &str), &Vec<Output>)| {
        let cells = outputs.iter().map(|output| cell(output, &mut reasons)).collect();
        (format!("`{}`", of.0), cells)
    };
    let kinds: Vec<_> = COMMANDS.iter().zip(&cells).map(row).collect();
    let long = COMMANDS.iter().zip(LONG).map(|((name, _), long)| (*name, long));
    let long: Vec<_> = long.collect();
    let used: Vec<_> = long.into_par_iter().map(|of| (format!("`{}`", of.0), ways(of))).collect();
    let reasons: String =
        (1..).zip(&reasons).map(|(k, reason)| format!("{k}. {reason}\n")).collect();
    let page = format!(
        "# Commands, systems and ways\n\nEach cell was run: ✓ works; a number is that of the reason \
         why it does not, as the program\nsays it.\n\n{}\n## Reasons\n\n{reasons}\n## Ways\n\n{}\n\
         Every command has `--json`. In Rust they are `verbs::Verb`s and `runs::compute`. Replicates \
         of\n`expect`, `equilibrium` and `lyapunov` are parts in [Python](python.md).\n",
        table("", &KINDS.map(|kind| kind.0), &kinds),
        table("", &WAYS, &used),
    );
    if env::var_os("WRITE").is_some() {
        fs::write(PAGE, &page).unwrap();
    }
    assert_eq!(fs::read_to_string(PAGE).unwrap_or_default(), page, "WRITE=1 writes it");
}
