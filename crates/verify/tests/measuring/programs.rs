//! The programs behind `cargo xtask bench` and `stability` as a user meets them.

use std::{fs, process::Command, thread::available_parallelism};

use real::Level;
use serde_json::Value;

/// Exit code, standard output and standard error.
fn run(program: &str, arguments: &[&str]) -> (Option<i32>, String, String) {
    let output = Command::new(program).args(arguments).output().expect("a program of this crate");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

const BENCH: &str = env!("CARGO_BIN_EXE_bench");
const HARD_CASES: &str = env!("CARGO_BIN_EXE_hard-cases");

#[test]
fn every_scheme_is_measured_on_every_system() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("speed.json");
    let level = Level::BUILT[0].name();
    let (code, page, errors) =
        run(BENCH, &["--quick", "--simd", level, "--json", file.to_str().unwrap()]);
    assert_eq!(code, Some(0), "{errors}");
    let report: Value = serde_json::from_slice(&fs::read(file).unwrap()).unwrap();
    let command = report["provenance"]["command"].as_str();
    assert!(command.is_some_and(|words| words.starts_with("cargo xtask bench --quick --simd")));
    let rows = report["rows"].as_array().expect("rows");
    let of = |what: &str| -> Vec<&Value> { rows.iter().filter(|row| row["of"] == what).collect() };
    let systems =
        ["pendulum", "rigid-body-1", "rigid-body-3", "lotka-volterra", "maxwell-bloch", "poisson3"];
    for system in systems {
        let on_it = of(system);
        assert_eq!(on_it[0]["workload"]["paths"], 256);
        let names: Vec<&str> = on_it.iter().filter_map(|row| row["scheme"].as_str()).collect();
        // Areas matter only where noises do not commute.
        let is_for = |id: &&str| match *id {
            "sexp-levy" | "sexp-li-levy" => system == "rigid-body-3",
            "split" | "nv" => system != "lotka-volterra",
            _ => true,
        };
        let all = schemes::BuiltIn::ALL.map(schemes::BuiltIn::id);
        assert_eq!(names, all.into_iter().filter(is_for).collect::<Vec<_>>(), "{system}");
        assert!(page.contains(system), "{system} is not on the page");
    }
    for row in rows {
        let spread = &row["ns_per_path_step"];
        let spread = ["best", "median", "worst"].map(|field| spread[field].as_f64().unwrap());
        assert!(row["failed"] == 0 && 0.0 < spread[0] && spread.is_sorted(), "{row}");
        // On Linux the kernel tells the memory of a process.
        assert!(row["peak_memory_mb"].as_f64().is_none_or(|mb| mb > 0.0));
    }
    let processors = available_parallelism().map_or(1, usize::from);
    for (what, field) in
        [("threads", "threads"), ("samples", "paths"), ("steps", "steps"), ("levels", "levels")]
    {
        let grows = of(what).into_iter().map(|row| row["workload"][field].as_u64().unwrap());
        let grows: Vec<u64> = grows.collect();
        assert!(!grows.is_empty() && grows.is_sorted(), "{what} {grows:?}");
        assert!(what != "threads" || grows[grows.len() - 1] == processors as u64);
    }
}

#[test]
fn no_guarantee_is_refuted_and_schemes_fail_where_they_must() {
    let (code, text, _) = run(HARD_CASES, &[]);
    assert!(code == Some(0) && text.contains(", 0 refuted\n"), "{text}");
    assert!(!text.contains("REFUTED"), "{text}");
    let cases: Vec<&str> = text.split("\n\n").collect();
    assert_eq!(cases.len(), 8, "seven cases and the counts");
    // Whether a scheme fails in any setting of a case.
    let fails = |id: &str, scheme: &str| {
        let case = cases.iter().find(|case| case.starts_with(id)).expect("the case");
        let mut cells = case.split([':', '|', '\n']).map(str::trim);
        cells.any(|cell| cell.starts_with(&format!("{scheme} ")) && cell.contains('✗'))
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

    // The same seed gives the same bits.
    let case = |seed| run(HARD_CASES, &["--only", "large-noise", "--seed", seed]).1;
    assert_eq!(case("1"), case("1"));
    assert_ne!(case("1"), case("2"));
}

#[test]
fn what_cannot_be_done_is_refused_in_words() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("a-file");
    fs::write(&file, "not a folder").unwrap();
    let below = file.join("speed.json");
    let below = ["--quick", "--json", below.to_str().unwrap()];
    let mut refused: Vec<(_, &[&str], &[&str])> = vec![
        (BENCH, &below, &["a-file"]),
        (BENCH, &["--simd", "mmx"], &["this machine does not have it, only"]),
        (HARD_CASES, &["--only", "big"], &["'big'", "large-noise", "stiff-damping"]),
    ];
    if Level::available() < Level::Avx512 {
        refused.push((BENCH, &["--simd", "avx512"], &["this machine does not have it"]));
    }
    for (program, arguments, words) in refused {
        let (code, _, message) = run(program, arguments);
        assert_eq!(code, Some(2), "{message}");
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    }
}
