//! `cargo xtask reproduce` as a user meets it: the same bits however it is run, and clear words for
//! bad input.

mod common;

use std::fs;

use common::{reproduce, results};
use serde_json::Value;

#[test]
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

    // Further series leave the others as they are.
    let ids = ["poisson3-strong", "maxwell-bloch-casimir"];
    let only: Vec<&str> = ids.iter().flat_map(|&id| ["--only", id]).collect();
    let more = run("more", &[&only[..], &["--with", "sexp-li,split"]].concat());
    for id in ids {
        let series = |results: &Value| find(results, id)["series"].as_array().unwrap().clone();
        let (mut all, paper) = (series(&more), series(&reference));
        assert_eq!(3 * all.len(), 5 * paper.len());
        all.retain(|series| !["sexp-li", "split"].iter().any(|id| series["scheme"] == *id));
        assert_eq!(all, paper);
    }
}

#[test]
fn paths_are_multiplied_in_whole_groups() {
    let dir = tempfile::tempdir().unwrap();
    let run = |times: &str| {
        reproduce(dir.path(), &["--only", "poisson3-strong", "--samples-times", times])
    };
    assert!(run("1.3").status.success());
    let panel = results(dir.path())["panels"][0].clone();
    // 512·1.3 = 665.6 paths are six groups of 128.
    assert_eq!(panel["samples"], 768);
    assert!(panel["setup"].as_str().unwrap().contains("1.3 times the quick mode's paths"));
    let refused = run("0.5");
    let message = String::from_utf8_lossy(&refused.stderr);
    assert!(!refused.status.success() && message.contains("from 1"), "{message}");
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
