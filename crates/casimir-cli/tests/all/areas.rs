//! Lévy areas for systems from text: strong order one where noises do not commute.

use crate::common::{json, with_scene};

/// A spin in two random fields, one of them with a term that is not linear.
const TWO_NOISES: &str = r#"[system]
state = ["x", "y", "z"]
B = [["-z", "y"], ["-x"]]
H0 = "x^2/2 + y^2 + 3*z^2/4"
H = ["x", "y^2/2 + z"]
[damping]
rate = "0.2"
[run]
initial = [0.6, 0.0, 0.8]
until = 1.0
steps = 64
"#;

/// The interval of the measured strong order of a scheme.
fn strong_order(scheme: &str) -> [f64; 2] {
    let folder = with_scene(&format!("{TWO_NOISES}scheme = \"{scheme}\"\n"));
    let found = json(folder.path(), &["order", "scene.toml", "--json"]);
    let rate = &found["strong"]["rate"];
    ["lo", "hi"].map(|end| rate[end].as_f64().unwrap_or_else(|| panic!("{scheme}: {found}")))
}

#[test]
#[ignore = "long: run by the gate"]
fn two_noises_that_do_not_commute_have_strong_order_one_with_areas() {
    let contains = |[lo, hi]: [f64; 2], order: f64| lo <= order && order <= hi && hi - lo < 0.2;
    for scheme in ["sexp-li-levy", "sexp-levy"] {
        let found = strong_order(scheme);
        assert!(contains(found, 1.0), "{scheme}: {found:?}");
    }
    // The twin without areas.
    let found = strong_order("sexp-li");
    assert!(contains(found, 0.5), "{found:?}");
}

#[test]
#[ignore = "long: run by the gate"]
fn a_comparison_takes_areas_and_a_reference_with_areas() {
    let folder = with_scene(TWO_NOISES);
    let arguments = ["compare", "scene.toml", "--error", "0.01", "--budget", "20", "--json"];
    let json = json(folder.path(), &arguments);
    let text = json.to_string();
    assert_eq!(json["sampled"]["reference"], "sexp-levy");
    for scheme in ["\"sexp-levy\"", "\"sexp-li-levy\"", "\"sexp-li\"", "\"heun\""] {
        assert!(text.contains(scheme), "{scheme}: {text}");
    }
}

/// A free particle, q = ∫W ds: every step of `split-h` is exact with the right law of the areas,
/// and Sobol points need few paths.
#[test]
fn means_of_space_time_areas_are_exact() {
    let scene = with_scene(
        r#"
[system]
state = ["q", "p"]
B = "canonical"
H0 = "p^2/2"
H = ["q"]
[run]
initial = [0, 0]
until = 2
steps = 16
scheme = "split-h"
[expect]
of = ["q^2", "q*p", "p^2"]
accuracy = 1e-4
"#,
    );
    let found = json(scene.path(), &["expect", "scene.toml", "--json"]);
    for (estimate, exact) in
        found["estimates"].as_array().unwrap().iter().zip([8.0 / 3.0, 2.0, 2.0])
    {
        let of = |key: &str| estimate[key].as_f64().unwrap();
        assert!((of("value") - exact).abs() < of("half_width"), "{estimate}");
        assert!(of("half_width") <= 1e-4, "{estimate}");
    }
    // Random points take 3e9.
    assert!(found["path_steps"].as_f64().unwrap() < 1e8, "{found}");
}
