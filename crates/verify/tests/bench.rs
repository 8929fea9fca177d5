//! The program behind `cargo xtask bench`: everything is measured, wrong requests are refused.

use std::fs;
use std::process::{Command, Output};

use real::Level;
use serde_json::Value;

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_bench"))
        .args(arguments)
        .output()
        .expect("the program of this crate runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn every_scheme_is_measured_on_every_system() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("speed.json");
    let level = Level::BUILT[0].name();
    let output = run(&["--quick", "--simd", level, "--json", file.to_str().unwrap()]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let (page, report): (_, Value) =
        (text(&output.stdout), serde_json::from_slice(&fs::read(file).unwrap()).unwrap());
    let command = report["provenance"]["command"].as_str();
    assert_eq!(command, Some(&*format!("cargo xtask bench --quick --simd {level}")));
    let rows = report["rows"].as_array().expect("rows");
    let grows = ["threads", "samples", "steps", "levels"];
    let of = |row: &Value| row["of"].as_str().unwrap().to_owned();
    let (growth, schemes): (Vec<&Value>, Vec<&Value>) =
        rows.iter().partition(|row| grows.contains(&&*of(row)));
    assert_eq!(schemes[0]["workload"]["paths"], 256);
    let mut systems: Vec<String> = schemes.iter().map(|row| of(row)).collect();
    systems.dedup();
    assert_eq!(systems.len(), 6, "{systems:?}");
    for system in &systems {
        let on_it = schemes.iter().filter(|row| row["of"] == **system);
        let names: Vec<&str> = on_it.filter_map(|row| row["scheme"].as_str()).collect();
        // Areas matter only where noises do not commute.
        let levy: &[&str] = match &**system {
            "rigid-body-3" => &["sexp-levy", "sexp-li-levy"],
            _ => &[],
        };
        let flows = system != "lotka-volterra";
        let by_parts: &[&str] = if flows { &["split", "nv"] } else { &[] };
        let all = [&["sexp"], levy, &["sexp-li"], by_parts, &["midpoint", "heun", "em"]].concat();
        assert_eq!(names, all, "{system}");
        assert!(page.contains(&**system), "{system} is not on the page");
    }
    for row in rows {
        let spread = &row["ns_per_path_step"];
        let [best, median, worst] =
            ["best", "median", "worst"].map(|field| spread[field].as_f64().unwrap());
        assert_eq!(row["failed"], 0, "{row}");
        assert!(0.0 < best && best <= median && median <= worst, "{row}");
    }
    for (what, field) in grows.into_iter().zip(["threads", "paths", "steps", "levels"]) {
        let rows = growth.iter().filter(|row| row["of"] == what);
        let values: Vec<u64> = rows.map(|row| row["workload"][field].as_u64().unwrap()).collect();
        assert!(!values.is_empty() && values.is_sorted(), "{what} {values:?}");
        if what == "threads" {
            let processors = std::thread::available_parallelism().map_or(1, usize::from);
            assert_eq!((values[0], values[values.len() - 1]), (1, processors as u64));
        }
    }
    // On Linux the kernel tells the memory of a process.
    if cfg!(target_os = "linux") {
        assert!(rows[0]["peak_memory_mb"].as_f64().is_none_or(|mb| mb > 0.0));
    }
}

#[test]
fn what_cannot_be_done_is_refused_before_anything_is_measured() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("a-file");
    fs::write(&file, "not a folder").unwrap();
    let below = file.join("speed.json");
    let mut refused = vec![
        (vec!["--quick", "--json", below.to_str().unwrap()], "a-file"),
        (vec!["--repetitions", "0"], "--repetitions"),
        (vec!["--simd", "mmx"], "this machine does not have it, only"),
    ];
    if Level::available() < Level::Avx512 {
        refused.push((vec!["--simd", "avx512"], "this machine does not have it"));
    }
    for (arguments, word) in refused {
        let output = run(&arguments);
        let message = text(&output.stderr);
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{message}");
        assert!(message.contains(word), "{message}");
    }
}
