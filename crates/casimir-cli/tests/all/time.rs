//! Hamiltonians that depend on time.

use crate::common::{fails, json, succeeds, with_scene};

/// A spin in a field that turns with its precession: s_z = cos(bt) (Rabi 1937).
const RABI: &str = r#"[system]
state = ["s[xyz]"]
parameters = { h = 2, b = 0.7 }
B = "spins"
H0 = "h*sz + b*(cos(h*t)*sx - sin(h*t)*sy)"
[run]
initial = [0, 0, 1]
until = 2
steps = 64
[observe]
twice = "2*t"
energy = "H0"
"#;

/// The last values of a path.
fn last(scene: &str, options: &[&str], names: &[&str]) -> Vec<f64> {
    let folder = with_scene(scene);
    succeeds(folder.path(), &[&["run", "scene.toml", "--write", "json"], options].concat());
    let text = std::fs::read_to_string(folder.path().join("scene-run/paths.json")).unwrap();
    let paths: serde_json::Value = serde_json::from_str(&text).unwrap();
    let columns = paths[0]["columns"].as_array().unwrap();
    let value = |name: &&str| {
        let column = columns.iter().find(|column| column["name"] == **name).expect(name);
        column["values"].as_array().unwrap().last().unwrap().as_f64().unwrap()
    };
    names.iter().map(value).collect()
}

#[test]
fn a_field_that_turns_flips_a_spin_with_order_two_and_keeps_its_length() {
    for scheme in ["sexp", "sexp-li", "heun"] {
        let error = |steps: &str| {
            let names = ["sx", "sy", "sz", "twice", "energy"];
            let found = last(RABI, &["--scheme", scheme, "--steps", steps], &names);
            let [x, y, z] = [found[0], found[1], found[2]];
            if scheme != "heun" {
                assert!((x * x + y * y + z * z - 1.0).abs() < 1e-13);
            }
            assert_eq!(found[3], 4.0);
            let field = 2.0 * z + 0.7 * (4f64.cos() * x - 4f64.sin() * y);
            assert!((found[4] - field).abs() < 1e-14);
            (z - 1.4f64.cos()).abs()
        };
        let (coarse, fine) = (error("64"), error("256"));
        assert!(coarse < 1e-3 && coarse / fine > 13.0, "{scheme}: {coarse} {fine}");
    }
}

/// The wrong method: the field of the beginning of each step.
#[test]
fn a_field_of_the_beginning_of_a_step_has_order_one() {
    let error = |steps: u32| {
        let late = RABI.replace("h*t", &format!("h*(t - 1/{steps})"));
        let found = last(&late, &["--steps", &steps.to_string()], &["sx"]);
        (found[0] - 4f64.sin() * 1.4f64.sin()).abs()
    };
    assert!(error(64) / error(256) < 5.0);
}

/// dq = sin(t) dW: the variance is ∫ sin².
#[test]
fn noise_that_depends_on_time_has_its_variance() {
    let scene = r#"[system]
state = ["q", "p"]
B = "canonical"
H0 = "0*p"
H = ["sin(t)*p"]
[run]
initial = [0, 0]
until = 2
steps = 64
paths = 20000
"#;
    let folder = with_scene(scene);
    let found = json(folder.path(), &["run", "scene.toml", "--json"])["at_end"]["q"].clone();
    let (variance, truth) = (found["variance"].as_f64().unwrap(), 1.0 - 4f64.sin() / 4.0);
    // Of a normal law the standard error is √(2/n); the middles of steps give 1 − τ²/6 at most.
    assert!((variance / truth - 1.0).abs() < 4.5 * (2.0f64 / 20_000.0).sqrt() + 2e-4);
}

#[test]
fn inspect_says_what_time_changes() {
    let folder = with_scene(RABI);
    let text = succeeds(folder.path(), &["inspect", "scene.toml"]);
    for words in ["cos(2 t)", "Casimirs are kept, energies are not", "0.5 sx² + 0.5 sy² + 0.5 sz²"]
    {
        assert!(text.contains(words), "{words}: {text}");
    }
    let text = succeeds(folder.path(), &["run", "scene.toml"]);
    assert!(text.contains("but for what depends on time"), "{text}");
    // At each time H₁ is a multiple of H₀, and there is no law of the energy.
    let applies = |factor: &str| {
        let scene = format!(
            "[system]\nstate = [\"q\", \"p\"]\nB = \"canonical\"\nH0 = \"{factor}*(q^2 + p^2)\"\n\
             H = [\"0.3*(q^2 + p^2)\"]\n[run]\ninitial = [1, 0]\nuntil = 1\nsteps = 8\n"
        );
        let found = json(with_scene(&scene).path(), &["inspect", "scene.toml", "--json"]);
        let theorems = found["theorems"].as_array().unwrap();
        let energy = theorems.iter().find(|theorem| theorem["statement"] == "energy-balance");
        energy.unwrap()["applies"].clone()
    };
    assert_eq!([applies("0.5"), applies("(2 + cos(t))")], ["yes", "no"]);
}

#[test]
fn b_has_no_time() {
    let scene = RABI.replace("B = \"spins\"", "B = [[\"t\", \"0\"], [\"0\"]]");
    let folder = with_scene(&scene);
    fails(folder.path(), &["run", "scene.toml"], 2, &["unknown name `t`"]);
}
