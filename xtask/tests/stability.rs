//! `cargo xtask stability` as a user meets it.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn stability(out: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_xtask"))
        .args(["stability", "--quick", "--out"])
        .arg(out)
        .args(arguments)
        .output()
        .expect("the binary of this crate runs")
}

#[test]
fn every_case_has_rows_and_words_and_nothing_is_refuted() {
    let dir = tempfile::tempdir().unwrap();
    let page = dir.path().join("docs/page.md");
    let output = stability(dir.path(), &["--inputs", "5000", "--page", page.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    let text = fs::read_to_string(dir.path().join("stability.json")).unwrap();
    let results: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(
        (results["schema"].as_u64(), results["provenance"]["mode"].as_str()),
        (Some(1), Some("quick"))
    );
    let text = fs::read_to_string(dir.path().join("stability.md")).unwrap();
    assert_eq!(text, fs::read_to_string(&page).unwrap());
    assert!(!text.contains("REFUTED") && text.contains("command line"));
    for case in results["cases"].as_array().unwrap() {
        assert!(!case["rows"].as_array().unwrap().is_empty());
        assert!(text.contains(case["title"].as_str().unwrap()));
    }
    for name in ["stability-stiff.svg", "stability-growth.svg"] {
        assert!(text.contains(name) && page.parent().unwrap().join("figures").join(name).is_file());
    }
}

#[test]
fn a_part_alone_and_a_bad_request() {
    let dir = tempfile::tempdir().unwrap();
    let output = stability(&dir.path().join("one"), &["--only", "equilibria"]);
    assert!(output.status.success());
    let out = dir.path().join("none");
    let output = stability(&out, &["--only", "equilibrium"]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2));
    for word in ["\"equilibrium\"", "equilibria", "growth", "fuzz"] {
        assert!(message.contains(word), "{message}");
    }
    assert!(!out.exists());
}
