//! Expectations where levels do not help, and accuracies that take long.

use crate::common::{fails, json, with_scene};

/// First passage of a Brownian motion with drift.
const WALK: &str = r#"[system]
state = ["q", "p"]
parameters = { mu = 0.3, sigma = 0.8 }
B = "canonical(q, p)"
H0 = "mu*p"
H = ["sigma*p"]
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

/// Φ((μT − 1)/σ√T) + e^{2μ/σ²}Φ((−1 − μT)/σ√T) at T = 2.
const PASSED: f64 = 0.562_675_6;

#[test]
fn single_paths_give_first_passages_with_less_work() {
    let folder = with_scene(WALK);
    let mut misses = 0;
    for seed in ["1", "2", "3", "4", "5", "6"] {
        let found = json(folder.path(), &["expect", "scene.toml", "--json", "--seed", seed]);
        let number = |key: &str| found["estimates"][0][key].as_f64().expect("a number");
        assert_eq!(found["reached"], true, "{found}");
        assert_eq!(found["single_steps"], 128, "{found}");
        // 10⁴ independent paths of 128 steps have this half-width; levels take 5.6e6 path-steps.
        assert!(found["path_steps"].as_f64().expect("a number") < 2.5e6, "{found}");
        misses += u32::from(PASSED < number("lo") || number("hi") < PASSED);
    }
    // Three of six or more with probability 2e-3.
    assert!(misses < 3, "{misses}");
}

#[test]
fn an_accuracy_that_is_not_reached_is_said_with_the_time_it_takes() {
    let scene = r#"[system]
state = ["q", "p"]
B = "canonical(q, p)"
H0 = "p^2/2 + q^2/2"
[damping]
rates = { p = 1 }
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
