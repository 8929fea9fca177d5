//! Programs are told what readers are told.

use crate::common::{OSCILLATOR, json, run, succeeds, with_scene};

/// Every measurement has the random numbers of its seed, and of no other.
#[test]
fn seeds_are_those_that_were_asked_for() {
    let folder = with_scene(&OSCILLATOR.replace("0.05", "0.5"));
    for (command, key) in [("expect", "estimates"), ("order --path-steps 1e4", "strong")] {
        let found = |seed: &str| {
            let (verb, options) = command.split_once(' ').unwrap_or((command, ""));
            let line = format!("{verb} scene.toml {options} --json --seed {seed}");
            let found = json(folder.path(), &line.split_whitespace().collect::<Vec<_>>());
            assert!(!found[key].is_null(), "{found}");
            found[key].clone()
        };
        assert_eq!(found("1"), found("1"), "{command}");
        assert_ne!(found("1"), found("2"), "{command}");
    }
}

/// Warnings of JSON as they are printed.
fn sentences(warnings: &serde_json::Value) -> Vec<String> {
    let all: Vec<casimir::stats::Warning> = serde_json::from_value(warnings.clone()).unwrap();
    all.iter().map(ToString::to_string).collect()
}

/// With so large steps.
#[test]
fn json_has_the_warnings_that_are_printed() {
    let scene = OSCILLATOR.replace("until = 2.0", "until = 40.0");
    let folder = with_scene(&scene.replace("accuracy = 0.05", "accuracy = 0.5"));
    let check = |command: &str, most: usize| {
        let arguments: Vec<&str> = command.split(' ').collect();
        let printed = succeeds(folder.path(), &arguments);
        let printed = printed.lines().filter_map(|line| line.strip_prefix("warning: "));
        let printed: Vec<&str> = printed.collect();
        let found = json(folder.path(), &[&arguments[..], &["--json"]].concat());
        assert_eq!(sentences(&found["warnings"]), printed, "{command}");
        assert!(printed.len() >= most, "{command}: {printed:?}");
        found
    };
    check("run scene.toml --paths 200", 1);
    check("run scene.toml --paths 3", 1);
    // A law without a mean.
    let heavy = OSCILLATOR.replace("of = [\"energy\", \"q\"]", "of = [\"exp(20*q)\"]");
    let output = run(with_scene(&heavy).path(), &["expect", "scene.toml", "--json"]);
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(found["warnings"][0]["what"].as_str().unwrap().contains("perhaps no mean"), "{found}");
    let sweep = check("run scene.toml --paths 200 --set s=0.2,0.3", 2);
    assert!(!sentences(&sweep["runs"][0]["warnings"]).is_empty(), "{sweep}");
    for command in ["inspect", "expect", "order --path-steps 1e4", "compare --budget 0.3"] {
        let (verb, options) = command.split_once(' ').unwrap_or((command, ""));
        check(format!("{verb} scene.toml {options}").trim_end(), 0);
    }
}
