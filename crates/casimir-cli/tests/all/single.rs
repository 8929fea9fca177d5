//! Expectations where levels do not help, and accuracies that take long.

use crate::common::{fails, json, with_scene};

/// A pendulum that is kicked, from the middle of its well: paths part at its top.
const KICKED: &str = r#"[system]
state = ["q", "p"]
B = "canonical(q, p)"
H0 = "p^2/2 - cos(q)"
H = ["0.5*q"]
[run]
initial = [0, 1]
until = 20
steps = 400
[expect]
of = ["cos(q)"]
accuracy = 0.03
"#;

/// By 10⁶ paths of 800 steps, ±0.0014.
const COSINE: f64 = 0.1396;

#[test]
fn single_paths_are_taken_where_paths_part_with_less_work() {
    let folder = with_scene(KICKED);
    let mut misses = 0;
    for seed in ["1", "2", "3", "4"] {
        let found = json(folder.path(), &["expect", "scene.toml", "--json", "--seed", seed]);
        let number = |key: &str| found["estimates"][0][key].as_f64().expect("a number");
        assert_eq!(found["reached"], true, "{found}");
        assert!(found["single_steps"].as_u64() >= Some(64), "{found}");
        // 5000 independent paths of 512 steps have this half-width; levels take 6e7 path-steps for
        // two thirds of it.
        assert!(found["path_steps"].as_f64().expect("a number") < 1.5e7, "{found}");
        misses += u32::from(COSINE < number("lo") || number("hi") < COSINE);
    }
    // Three of four or more with probability 5e-4.
    assert!(misses < 3, "{misses}");
}

#[test]
fn levels_are_taken_where_they_couple_paths() {
    // First passage of a Brownian motion with drift: Φ((μT − 1)/σ√T) + e^{2μ/σ²}Φ((−1 − μT)/σ√T).
    let walk = r#"[system]
state = ["q", "p"]
B = "canonical(q, p)"
H0 = "0.3*p"
H = ["0.8*p"]
[run]
initial = [0, 0]
until = 2
steps = 32
[events]
hit = "q > 1"
[expect]
of = ["hit"]
accuracy = 0.01
"#;
    let folder = with_scene(walk);
    let found = json(folder.path(), &["expect", "scene.toml", "--json"]);
    assert!(found["single_steps"].is_null(), "{found}");
    let number = |key: &str| found["estimates"][0][key].as_f64().expect("a number");
    assert!(number("lo") < 0.562_675_6 && 0.562_675_6 < number("hi"), "{found}");
}

#[test]
fn an_accuracy_that_is_not_reached_is_said_with_the_time_it_takes() {
    let scene = r#"[system]
state = ["q", "p"]
B = "canonical(q, p)"
H0 = "p^2/2 + q^2/2"
[bath]
friction = { p = 1 }
temperature = 1
[run]
initial = [0, 0]
until = 5
steps = 100
[expect]
of = ["q^2"]
accuracy = 1e-4
"#;
    let folder = with_scene(scene);
    let command = ["equilibrium", "scene.toml", "--path-steps", "1e6"];
    let words = ["1e-4 is not reached in 0.", " minutes: ±", " so far, about ", " more"];
    fails(folder.path(), &command, 1, &words);
}
