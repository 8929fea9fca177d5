//! The program as `cargo xtask bench` runs it: everything is measured, and asked for in vain is
//! refused.

use std::fs;
use std::process::{Command, Output};

use speed::{Speed, Workload};

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_speed"))
        .args(arguments)
        .output()
        .expect("the binary of this crate runs")
}

fn quick() -> (Speed, String) {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("speed.json");
    let output = run(&["--quick", "--json", file.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let speed = serde_json::from_slice(&fs::read(file).unwrap()).unwrap();
    (speed, String::from_utf8(output.stdout).unwrap())
}

#[test]
fn every_scheme_is_measured_on_every_system() {
    let (speed, page) = quick();
    assert_eq!(speed.workload, Workload::quick());
    let mut systems: Vec<&str> = speed.schemes.iter().map(|row| row.system.as_str()).collect();
    systems.dedup();
    assert_eq!(systems.len(), 9, "{systems:?}");
    for system in &systems {
        let on_it = speed.schemes.iter().filter(|row| row.system == *system);
        let schemes: Vec<&str> = on_it.map(|row| row.scheme.as_str()).collect();
        // Areas matter only where noises do not commute.
        let commuting = !["rigid body, three noises", "spin chain, two spins"].contains(system);
        assert_eq!(schemes.contains(&"sexp-levy"), !commuting, "{system}");
        for scheme in ["sexp", "midpoint", "heun", "em"] {
            assert!(schemes.contains(&scheme), "{scheme} on {system}");
        }
        assert!(page.contains(system), "{system} is not on the page");
    }
    for row in &speed.schemes {
        let spread = row.ns_per_path_step;
        assert_eq!(row.failed, 0, "{row:?}");
        assert!(
            0.0 < spread.best && spread.best <= spread.median && spread.median <= spread.worst,
            "{row:?}"
        );
    }
}

#[test]
fn threads_and_growth_are_measured() {
    let (speed, _) = quick();
    assert_eq!((speed.threads[0].threads, speed.threads[0].speedup), (1, 1.0));
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    assert_eq!(speed.threads.last().unwrap().threads, processors);
    for grows in ["samples", "steps", "levels"] {
        let rows: Vec<_> = speed.growth.iter().filter(|row| row.grows == grows).collect();
        assert!(rows.len() >= 3, "{grows}");
        assert!(rows.windows(2).all(|pair| pair[0].value < pair[1].value), "{grows}");
    }
    // On Linux the kernel tells the memory of a process.
    if cfg!(target_os = "linux") {
        assert!(speed.peak_memory_mb.is_some_and(|mb| mb > 0.0));
    }
}

#[test]
fn a_file_that_cannot_be_written_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("no-such-folder").join("speed.json");
    let output = run(&["--quick", "--repetitions", "1", "--json", file.to_str().unwrap()]);
    assert!(!output.status.success());
    assert!(String::from_utf8_lossy(&output.stderr).contains("speed.json"));
    let output = run(&["--repetitions", "0"]);
    assert!(!output.status.success() && output.stdout.is_empty());
}
