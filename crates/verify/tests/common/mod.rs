//! The program `reproduce` at small sizes.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// Runs it.
pub fn reproduce(out: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_reproduce"))
        .args(["--quick", "--out"])
        .arg(out)
        .args(arguments)
        .output()
        .expect("the binary of this crate runs")
}

/// Everything but the provenance, which holds the timings.
pub fn results(out: &Path) -> Value {
    let text =
        fs::read_to_string(out.join("results.json")).expect("a successful run writes results.json");
    let mut results: Value = serde_json::from_str(&text).expect("results.json is JSON");
    let provenance = results.as_object_mut().and_then(|object| object.remove("provenance"));
    assert!(provenance.is_some(), "results.json says where it comes from");
    results
}
