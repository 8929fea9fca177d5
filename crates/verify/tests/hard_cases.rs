//! `cargo xtask stability` as a user meets it: no guarantee is refuted, schemes fail where theory
//! predicts it, and the same seed gives the same bits.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn run(out: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hard-cases"))
        .args(["--quick", "--out"])
        .arg(out)
        .args(arguments)
        .output()
        .expect("the program of this crate runs")
}

fn list<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value[key].as_array().expect("a list")
}

#[test]
fn no_guarantee_is_refuted_and_schemes_fail_where_they_must() {
    let dir = tempfile::tempdir().unwrap();
    let page = dir.path().join("docs/page.md");
    let output = run(dir.path(), &["--inputs", "5000", "--page", page.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    let json = fs::read_to_string(dir.path().join("stability.json")).unwrap();
    let results: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(
        (results["schema"].as_u64(), results["provenance"]["mode"].as_str()),
        (Some(1), Some("quick"))
    );

    let text = fs::read_to_string(dir.path().join("stability.md")).unwrap();
    assert_eq!(text, fs::read_to_string(&page).unwrap());
    assert!(!text.contains("REFUTED") && text.contains("steps of blocks"));
    for name in ["stability-stiff.svg", "stability-growth.svg"] {
        assert!(text.contains(name) && dir.path().join("docs/figures").join(name).is_file());
    }

    let cases = list(&results, "cases");
    assert_eq!(cases.len(), 14);
    let fails = |id: &str, scheme: &str| {
        let case = cases.iter().find(|case| case["id"] == id).expect("the case is there");
        let mut rows = list(case, "rows").iter();
        rows.any(|row| row["scheme"] == scheme && row["verdict"] == "fails-as-it-must")
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
    for case in cases {
        assert!(!list(case, "rows").is_empty() && text.contains(case["title"].as_str().unwrap()));
    }

    // Settled solvers and schemes without iteration leave a random walk, the default one a drift.
    for run in list(&results, "growth") {
        let verdict = if run["scheme"] == "sexp" { "fails-as-it-must" } else { "holds" };
        assert_eq!(run["verdict"], verdict, "{run}");
    }
    // What keeps the energy near does so on all systems; explicit methods drift or fail.
    let energy = list(&results, "energy");
    assert_eq!(energy.len(), 40);
    for run in energy {
        let keeps = ["sexp", "midpoint", "split", "nv"].iter().any(|name| run["scheme"] == *name);
        assert_eq!(run["outcome"] == "bounded", keeps, "{run}");
        assert_eq!(run["verdict"], if keeps { "holds" } else { "fails-as-it-must" }, "{run}");
    }
    for fuzzed in list(&results, "fuzz") {
        assert_eq!(fuzzed["failures"], 0, "{fuzzed}");
        assert!(fuzzed["accepted"] != 0 && fuzzed["refused"] != 0, "{fuzzed}");
    }
}

#[test]
fn the_same_seed_gives_the_same_bits() {
    let dir = tempfile::tempdir().unwrap();
    let cases = |seed: &str| {
        assert!(run(dir.path(), &["--only", "big-steps", "--seed", seed]).status.success());
        let json = fs::read_to_string(dir.path().join("stability.json")).unwrap();
        serde_json::from_str::<Value>(&json).unwrap()["cases"].clone()
    };
    assert_eq!(cases("1"), cases("1"));
    assert_ne!(cases("1"), cases("2"));
}

#[test]
fn a_case_that_does_not_exist_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("none");
    let output = run(&out, &["--only", "equilibrium"]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2));
    for word in ["'equilibrium'", "equilibria", "growth", "energy", "fuzz"] {
        assert!(message.contains(word), "{message}");
    }
    assert!(!out.exists());
}
