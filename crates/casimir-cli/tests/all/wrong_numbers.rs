//! Numbers that cannot be are refused with their key, before memory is taken for them.

use std::fs;

use crate::common::{OSCILLATOR, fails, json, succeeds, with_scene};

/// The scene with a line in the place of another.
fn with(line: &str, other: &str) -> String {
    assert!(OSCILLATOR.contains(line));
    OSCILLATOR.replace(line, other)
}

#[test]
fn each_key_says_what_it_may_be() {
    let bath =
        with("[damping]\nrate = \"0.1\"", "[bath]\nfriction = { p = 0.5 }\ntemperature = \"-k\"")
            .replace("H = [\"s*q\"]\n", "");
    let table = [
        (with("1.0, 0.5", "nan, 0.5"), "line 11, column 11: a number must be finite, got NaN"),
        (with("until = 2.0", "until = inf"), "line 12, column 9: a number must be finite, got inf"),
        (with("k = 1.0", "k = -inf"), "line 4, column 20: a number must be finite, got -inf"),
        (with("[1.0, 0.5]", "[]"), "line 11, column 11: the initial value has no component"),
        (with("paths = 4", "seed = -1"), "`-1` is not a seed: a whole number from 0 to 1844674407"),
        (with("paths = 4", "seed = 1.5"), "`1.5` is not a seed"),
        (with("paths = 4", "seed = \"one\""), "`one` is not a seed"),
        (bath.clone(), "kT must be positive, got -1 at t = 0"),
        (
            bath.replace("0.5 }", "\"0.5 - t\" }").replace("\"-k\"", "1"),
            "line 8, column 18: friction of `p` must not be negative, got",
        ),
    ];
    for (scene, words) in table {
        fails(with_scene(&scene).path(), &["run", "scene.toml"], 2, &[words]);
    }
    let folder = with_scene(OSCILLATOR);
    for seed in ["-1", "abc"] {
        let words = format!("`{seed}` is not a seed: a whole number from 0 to 1844674407");
        fails(folder.path(), &["run", "scene.toml", "--seed", seed], 2, &[&words]);
    }
    let largest = with_scene(&with("paths = 4", "seed = \"18446744073709551615\""));
    let found = json(largest.path(), &["run", "scene.toml", "--json"]);
    assert_eq!(found["seed"].as_u64(), Some(u64::MAX));
}

#[test]
fn threads_and_memory_have_limits() {
    let folder = with_scene(OSCILLATOR);
    let path = folder.path();
    let words = "cannot compute with 99999999 threads: 1024 are the most";
    fails(path, &["run", "scene.toml", "--threads", "99999999"], 2, &[words]);
    let times = with("steps = 64", "steps = 1e12\ntimes = 1e12");
    for (paths, what) in [("paths = 100", "tables of 3 paths"), ("", "tables of 1 path")] {
        fs::write(path.join("scene.toml"), times.replace("paths = 4", paths)).unwrap();
        fails(path, &["run", "scene.toml"], 2, &[what, " GB of memory, and "]);
    }
    assert!(!path.join("scene-run/index.html").exists());
}

#[test]
fn a_sweep_of_one_value_is_a_sweep() {
    let folder = with_scene(&(OSCILLATOR.to_owned() + "[sweep]\nk = [1.5]\n"));
    let swept = json(folder.path(), &["run", "scene.toml", "--json"]);
    assert_eq!(swept["sweep"], serde_json::json!({ "k": [1.5] }));
    // One value of the command line settles it.
    let settled = json(folder.path(), &["run", "scene.toml", "--json", "--set", "k=1.5"]);
    assert!(settled["sweep"].is_null());
    succeeds(folder.path(), &["expect", "scene.toml", "--set", "k=1.5"]);
}
