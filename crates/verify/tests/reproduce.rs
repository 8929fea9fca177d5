//! `cargo xtask reproduce` as a user meets it: the same bits however it is run, and clear words for
//! bad input.

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

use serde_json::Value;

/// Runs the program at small sizes.
fn reproduce(out: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_reproduce"));
    command.args(["--quick", "--out"]).arg(out).args(arguments).output().expect("it runs")
}

/// Everything but the provenance, which holds the timings.
fn results(out: &Path) -> Value {
    let text = fs::read(out.join("results.json")).expect("a successful run writes results.json");
    let mut results: Value = serde_json::from_slice(&text).expect("results.json is JSON");
    let provenance = results.as_object_mut().and_then(|object| object.remove("provenance"));
    assert!(provenance.is_some(), "results.json says where it comes from");
    results
}

#[test]
#[ignore = "long: run by the gate"]
fn results_are_the_same_bits_however_they_are_computed() {
    let dir = tempfile::tempdir().unwrap();
    let run = |name: &str, arguments: &[&str]| {
        let out = dir.path().join(name);
        let output = reproduce(&out, arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
        results(&out)
    };
    let reference = run("two-threads", &["--threads", "2"]);
    assert_eq!(reference["panels"].as_array().unwrap().len(), 14);

    // Panels alone and on one thread are those of the whole; with another seed they are not, or the
    // comparisons see nothing. `.ci/run` compares all panels at two levels of instructions.
    let ids = ["poisson3-strong", "rigid-body-weak-cos", "maxwell-bloch-casimir"];
    let only: Vec<&str> = ids.iter().flat_map(|&id| ["--only", id]).collect();
    let with = |more: &[&'static str]| [&only[..], more].concat();
    let part = run("part", &with(&["--threads", "1"]));
    let other_seed = run("other-seed", &with(&["--seed", "2"]));
    let find = |results: &Value, id: &str| {
        let panels = results["panels"].as_array().unwrap();
        panels.iter().find(|panel| panel["id"] == id).cloned().expect("the panel is there")
    };
    for results in [&part, &other_seed] {
        assert_eq!(results["panels"].as_array().unwrap().len(), ids.len());
    }
    for id in ids {
        assert_eq!(find(&reference, id), find(&part, id));
        assert_ne!(find(&reference, id), find(&other_seed, id));
    }
}

#[test]
fn what_was_not_asked_for_is_not_told() {
    let found = verify::reproduce(1, true, &["rigid-body-weak-y"]);
    assert!(!found.claims.is_empty() && found.panels.len() == 1);
    assert!(found.claims.iter().all(|claim| claim.panel == "rigid-body-weak-y"));
}

#[test]
fn wrong_requests_are_refused_before_any_computing() {
    let dir = tempfile::tempdir().unwrap();
    let (out, file) = (dir.path().join("out"), dir.path().join("a-file"));
    fs::write(&file, "not a folder").unwrap();
    let known = ["pendulum-weak", "pendulum-strong", "poisson3-casimir", "truncation-moments"];
    let below = file.join("below");
    for (out, arguments, words) in [
        (&out, &["--only", "pendulum-weak"][..], &known[..]),
        (&below, &[], &["a-file"]),
        (&out, &["--threads", "0"], &["0"]),
    ] {
        let output = reproduce(out, arguments);
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && output.stdout.is_empty(), "{message}");
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
        assert!(!out.exists(), "nothing is written for a request that makes no sense");
    }
}
