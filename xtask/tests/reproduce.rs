//! `cargo xtask reproduce` as a user meets it: the same bits however it is run, and clear words for bad input.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn reproduce(out: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_xtask"))
        .args(["reproduce", "--quick", "--out"])
        .arg(out)
        .args(arguments)
        .output()
        .expect("the binary of this crate runs")
}

/// Everything but the provenance, which holds the timings.
fn results(out: &Path) -> Value {
    let text = fs::read_to_string(out.join("results.json")).expect("a successful run writes results.json");
    let mut results: Value = serde_json::from_str(&text).expect("results.json is JSON");
    let provenance = results.as_object_mut().and_then(|object| object.remove("provenance"));
    assert!(provenance.is_some(), "results.json says where it comes from");
    results
}

#[test]
fn results_are_the_same_bits_on_any_threads_and_any_vectors() {
    let dir = tempfile::tempdir().unwrap();
    let run = |name: &str, arguments: &[&str]| {
        let out = dir.path().join(name);
        let output = reproduce(&out, arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
        results(&out)
    };
    let reference = run("one-thread", &["--threads", "1"]);
    assert_eq!(reference["panels"].as_array().unwrap().len(), 14);
    assert_eq!(reference, run("two-threads", &["--threads", "2"]));
    assert_eq!(reference, run("baseline", &["--simd", "baseline"]));
    assert_eq!(reference, run("avx2", &["--simd", "avx2"]));
    // The twin: another seed must not give the same results, or the comparison sees nothing.
    assert_ne!(reference, run("other-seed", &["--seed", "2"]));
}

#[test]
fn one_panel_alone_is_that_panel_of_the_whole() {
    let dir = tempfile::tempdir().unwrap();
    let (whole, part) = (dir.path().join("whole"), dir.path().join("part"));
    assert!(reproduce(&whole, &[]).status.success());
    assert!(reproduce(&part, &["--only", "poisson3-strong", "--only", "rigid-body-weak-cos"]).status.success());
    let (whole, part) = (results(&whole), results(&part));
    let find = |results: &Value, id: &str| {
        results["panels"]
            .as_array()
            .unwrap()
            .iter()
            .find(|panel| panel["id"] == id)
            .cloned()
            .expect("the panel is there")
    };
    assert_eq!(part["panels"].as_array().unwrap().len(), 2);
    for id in ["poisson3-strong", "rigid-body-weak-cos"] {
        assert_eq!(find(&whole, id), find(&part, id));
    }
}

#[test]
fn an_unknown_panel_is_refused_with_the_list_of_known_ones() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("out");
    let output = reproduce(&out, &["--only", "pendulum-weak"]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success());
    for word in ["pendulum-weak", "pendulum-strong", "poisson3-casimir", "truncation-moments"] {
        assert!(message.contains(word), "{message}");
    }
    assert!(!out.exists(), "nothing is written for a request that makes no sense");
}

#[test]
fn an_unwritable_folder_is_found_before_any_computing() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("a-file");
    fs::write(&file, "not a folder").unwrap();
    let output = reproduce(&file.join("below"), &[]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && output.stdout.is_empty(), "{message}");
    assert!(message.contains("a-file"), "{message}");
}

#[test]
fn zero_threads_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let output = reproduce(dir.path(), &["--threads", "0"]);
    assert!(!output.status.success() && String::from_utf8_lossy(&output.stderr).contains('0'));
}
