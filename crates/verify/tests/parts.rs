//! `cargo xtask reproduce` in parts: merged, extended, planned, stopped and resumed.

mod common;

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::time::Duration;

use analysis::{Mode, Settings, Silent};
use common::{reproduce, results};
use mc::parts::Job;
use serde_json::Value;
use verify::Method;

fn only(ids: &[&'static str]) -> Vec<&'static str> {
    ids.iter().flat_map(|&id| ["--only", id]).collect()
}

fn message(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn parts_in_any_order_are_the_whole() {
    let dir = tempfile::tempdir().unwrap();
    let (whole, parts) = (dir.path().join("whole"), dir.path().join("parts"));
    assert!(reproduce(&whole, &[]).status.success());
    // A run that came to its end has left no checkpoint.
    let left = |out: &Path| fs::read_dir(out).unwrap().map(|file| file.unwrap().file_name());
    let left: Vec<String> = left(&whole).map(|name| name.to_string_lossy().into_owned()).collect();
    assert!(!left.iter().any(|name| name.contains("part")), "{left:?}");

    let part = |number: &'static str, more: &[&'static str]| {
        reproduce(&parts, &[&["--parts", "3", "--part", number, "--threads", "1"], more].concat())
    };
    for number in ["3", "1"] {
        let output = part(number, &[]);
        assert!(output.status.success(), "{}", message(&output));
        assert!(!parts.join("results.json").exists());
    }
    let missing = message(&reproduce(&parts, &["--merge"]));
    assert!(missing.contains("--array=2"), "{missing}");
    let refused = message(&part("2", &["--seed", "2"]));
    assert!(refused.contains("--seed 1") && refused.contains("--seed 2"), "{refused}");
    assert!(part("2", &[]).status.success());
    let merged = reproduce(&parts, &["--merge"]);
    assert!(merged.status.success(), "{}", message(&merged));
    assert_eq!(results(&parts), results(&whole));
    assert!(parts.join("index.html").exists());
}

#[test]
fn a_larger_study_reuses_a_smaller_one() {
    let dir = tempfile::tempdir().unwrap();
    let (whole, parts) = (dir.path().join("whole"), dir.path().join("parts"));
    let some = only(&["poisson3-strong", "rigid-body-weak-cos"]);
    let run = |out: &Path, times: &str, more: &[&str]| {
        let output = reproduce(out, &[&some[..], &["--samples-times", times], more].concat());
        assert!(output.status.success(), "{}", message(&output));
    };
    for times in ["1", "1.3"] {
        run(&parts, times, &["--parts", "2", "--part", "2"]);
        run(&parts, times, &["--parts", "2", "--part", "1"]);
        run(&parts, times, &["--merge"]);
    }
    run(&whole, "1.3", &[]);
    let merged = results(&parts);
    assert_eq!(merged, results(&whole));
    // 512·1.3 = 665.6 paths are six groups of 128.
    assert_eq!(merged["panels"][1]["samples"], 768);
    let words = "1.3 times the quick mode's paths";
    assert!(merged["panels"][1]["setup"].as_str().unwrap().contains(words));
    let mut claims = merged["claims"].as_array().unwrap().iter();
    assert!(claims.all(|claim| claim["statement"].as_str().unwrap().contains(words)));
    let text = fs::read_to_string(parts.join("results.json")).unwrap();
    let provenance = &serde_json::from_str::<Value>(&text).unwrap()["provenance"];
    assert_eq!(provenance["samples_times"], 1.3);
    let smaller = [&some[..], &["--samples-times", "1.2", "--parts", "2", "--part", "1"]].concat();
    let refused = message(&reproduce(&parts, &smaller));
    assert!(refused.contains("can only grow"), "{refused}");
}

#[test]
fn a_plan_writes_a_script_that_computes_a_part() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("a run");
    let some = only(&["poisson3-strong"]);
    let options = ["--plan", "--parts", "4", "--account", "physics", "--cpus", "2"];
    let output = reproduce(&out, &[&some[..], &options].concat());
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{}", message(&output));
    for words in ["poisson3-strong/sexp+em+midpoint", "a cluster is not needed", "sbatch", "hq "] {
        assert!(text.contains(words), "{words} in\n{text}");
    }
    let script = fs::read_to_string(out.join("job.sh")).unwrap();
    for line in ["--array=1-4", "--account=physics", "--cpus-per-task=2", "--time=6"] {
        assert!(script.contains(&format!("#SBATCH {line}\n")), "{script}");
    }
    // 512 paths are four groups: each part has one.
    for part in ["1", "2", "3", "4"] {
        let job = Command::new("bash").arg(out.join("job.sh")).arg(part).output().unwrap();
        assert!(job.status.success(), "{}", message(&job));
    }
    let merged = reproduce(&out, &[&some[..], &["--merge"]].concat());
    assert!(merged.status.success(), "{}", message(&merged));
}

/// The largest of 64 parts has at most 5 % more path-steps than the mean, at the paper's sizes and
/// with every further scheme.
#[test]
fn parts_have_equal_work() {
    for further in [&[][..], &[Method::SexpLevy], &Method::FURTHER] {
        let job = Job::pilot(Duration::ZERO);
        verify::reproduce(Settings::new(1, Mode::Paper), &[], further, &job, &Silent).unwrap();
        let plan = job.plan().unwrap();
        assert!(plan.path_steps() > 1_000_000_000, "{plan:?}");
        let steps: Vec<u64> = plan.parts(64, 1).iter().map(|part| part.path_steps).collect();
        assert_eq!(steps.iter().sum::<u64>(), plan.path_steps());
        let mean = plan.path_steps() as f64 / 64.0;
        let largest = *steps.iter().max().unwrap() as f64;
        println!("{:.1e} path-steps, mean over largest {:.4}", 64.0 * mean, mean / largest);
        assert!(mean >= 0.95 * largest, "{mean} {largest}");
    }
}

#[cfg(unix)]
#[test]
fn a_run_that_is_stopped_goes_on() {
    use std::{process::Stdio, thread::sleep};
    let dir = tempfile::tempdir().unwrap();
    let (stopped, whole) = (dir.path().join("stopped"), dir.path().join("whole"));
    let some = only(&["rigid-body-weak-y"]);
    let run = |out: &Path| reproduce(out, &some);
    let mut child = Command::new(env!("CARGO_BIN_EXE_reproduce"))
        .args(["--quick", "--threads", "1", "--out"])
        .arg(&stopped)
        .args(&some)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The file is there before anything is computed.
    while !stopped.join("part-1-of-1.json").exists() {
        sleep(Duration::from_millis(5));
    }
    sleep(Duration::from_millis(300));
    let kill = Command::new("kill").args(["-TERM", &child.id().to_string()]).status();
    assert!(kill.unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(!stopped.join("results.json").exists());
    // With other arguments it is not the same run.
    let refused = message(&reproduce(&stopped, &[&some[..], &["--seed", "2"]].concat()));
    assert!(refused.contains("to begin anew, delete"), "{refused}");
    let output = run(&stopped);
    assert!(output.status.success(), "{}", message(&output));
    assert!(message(&output).contains("going on from a checkpoint"), "{}", message(&output));
    assert!(run(&whole).status.success());
    assert_eq!(results(&stopped), results(&whole));
}

#[test]
fn a_part_that_is_not_named_is_asked_for() {
    let dir = tempfile::tempdir().unwrap();
    for (arguments, words) in [
        (&["--parts", "4"][..], "--part 1 to --part 4"),
        (&["--parts", "4", "--part", "5"], "no part 5 of 4"),
        (&["--part", "1"], "--parts"),
        (&["--samples-times", "0.5"], "from 1"),
        (&["--account", "physics"], "--plan"),
    ] {
        let output = reproduce(dir.path(), arguments);
        assert!(!output.status.success() && message(&output).contains(words), "{arguments:?}");
    }
}
