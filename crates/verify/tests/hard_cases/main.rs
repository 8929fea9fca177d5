//! Hard cases: the program `cargo xtask stability`, the conformal law over ten million steps, the
//! energy over a million periods, and arbitrary inputs.
//!
//! Long runs and inputs are few here; the ignored tests have all of them:
//! `cargo test --release -p casimir-verify --features measuring --test hard_cases -- --ignored
//! --nocapture`.

mod bits;
mod energy;
mod fuzz;
mod growth;

use std::process::{Command, Output};

/// Master seed of everything here.
const SEED: u64 = 1;

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hard-cases"))
        .arg("--quick")
        .args(arguments)
        .output()
        .expect("the program of this crate runs")
}

#[test]
fn no_guarantee_is_refuted_and_schemes_fail_where_they_must() {
    let output = run(&[]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success() && text.contains(", 0 refuted\n"), "{text}");
    assert!(!text.contains("REFUTED") && !text.contains("NaN"), "{text}");
    let cases: Vec<&str> = text.split("\n\n").collect();
    assert_eq!(cases.len(), 13, "twelve cases and the counts");
    // Whether a scheme fails in any setting of a case.
    let fails = |id: &str, scheme: &str| {
        let is = |case: &&&str| case.lines().next() == Some(id);
        let case = cases.iter().find(is).unwrap_or_else(|| panic!("no case {id}"));
        let cells = |line: &str| line.split('|').map(|c| c.trim().to_owned()).collect::<Vec<_>>();
        let mut rows = case.lines().filter(|line| line.starts_with('|')).map(cells);
        let column = rows.next().and_then(|head| head.iter().position(|name| name == scheme));
        let column = column.unwrap_or_else(|| panic!("{id} has no {scheme}"));
        rows.any(|row| row[column].ends_with('✗'))
    };
    for (id, scheme) in [
        ("stiff-damping", "em"),
        ("stiff-damping", "heun"),
        ("stiff-damping", "midpoint"),
        ("rough-damping", "em"),
        ("rough-damping", "midpoint"),
        ("stiff-hamiltonian", "heun"),
        ("anti-damping", "midpoint"),
    ] {
        assert!(fails(id, scheme), "{id} {scheme}");
    }
    assert!(!fails("stiff-damping", "sexp"));
}

#[test]
fn the_same_seed_gives_the_same_bits() {
    let cases = |seed: &str| {
        let output = run(&["--only", "big-steps", "--seed", seed]);
        assert!(output.status.success());
        output.stdout
    };
    assert_eq!(cases("1"), cases("1"));
    assert_ne!(cases("1"), cases("2"));
}

#[test]
fn a_case_that_does_not_exist_is_refused() {
    let output = run(&["--only", "equilibrium"]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2));
    for word in ["'equilibrium'", "equilibria", "near-singular"] {
        assert!(message.contains(word), "{message}");
    }
}
