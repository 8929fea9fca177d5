//! Scenes of matrices: known answers by default settings, and mistakes that are named.

use std::{fs, path::Path};

use casimir::schemes::BuiltIn;
use serde_json::Value;

use crate::common::{json, run};

const FLUID: &str = r#"
[system]
name = "sphere-euler"
parameters = { size = 5, advection = 0, degrees = [2], strengths = ["sqrt(16*pi/120)"], spectrum = 4 }
[run]
initial = [0, 1, 0]
until = 0.25
steps = 32
[expect]
of = ["energy", "enstrophy"]
accuracy = 1e-3
"#;

const SPIN: &str = r#"
[system]
name = "su-spins"
parameters = { levels = 3, quadratic = 1 }
[bath]
temperature = 0.125
transverse = { s = 1 }
[run]
initial = [1, 0, 0]
until = 4
steps = 200
[expect]
of = ["energy"]
accuracy = 0.02
"#;

/// A qubit that turns about y and is dephased along z, with decay rates ½g² of x and y.
const QUBIT: &str = r#"
[system]
name = "quantum"
[system.parameters]
g = 0.8
hamiltonian = [0, "-i", "i", 0]
noises = ["g/2", 0, 0, "-g/2"]
[run]
initial = [1, 0]
until = 1
steps = 64
[expect]
of = ["p1 - p2", "purity"]
accuracy = 5e-3
"#;

fn found(folder: &Path, verb: &str, scene: &str) -> Value {
    fs::write(folder.join("scene.toml"), scene).unwrap();
    json(folder, &[verb, "scene.toml", "--json"])
}

/// Asserts that an estimate is within 2.5 half-widths of 95 %: false alarms have a probability of
/// 1e-6. Returns how far it is from another value, in half-widths.
fn near(found: &Value, k: usize, known: f64, other: f64) -> f64 {
    let of = |key: &str| found["estimates"][k][key].as_f64().unwrap();
    let (middle, half) = (0.5 * (of("lo") + of("hi")), 0.5 * (of("hi") - of("lo")));
    assert!((middle - known).abs() < 2.5 * half.max(1e-12), "{middle} ± {half}, known {known}");
    (middle - other).abs() / half
}

#[test]
fn known_answers_of_texts() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let fluid = found(path, "expect", FLUID);
    // The twin is what there was at the beginning.
    assert!(near(&fluid, 0, 0.2135905989, 0.25) > 5.0);
    near(&fluid, 1, 1.0, 0.9);
    let spin = found(path, "equilibrium", SPIN);
    assert!(near(&spin, 0, 0.2473081719, 1.0 / 3.0) > 2.5);
    // d(x, z)/dt = (2z − ½g²x, −2x).
    let (mut x, mut z, h) = (0.0, 1.0, 1e-5);
    let field = |x: f64, z: f64| (2.0 * z - 0.32 * x, -2.0 * x);
    for _ in 0..100_000 {
        let (a, b) = field(x, z);
        let (a, b) = field(x + 0.5 * h * a, z + 0.5 * h * b);
        (x, z) = (x + h * a, z + h * b);
    }
    let qubit = found(path, "expect", QUBIT);
    assert!(near(&qubit, 0, z, 2f64.cos()) > 2.5);
    near(&qubit, 1, 1.0, 0.9);
}

/// Orders are listed of those schemes alone that run: each is tried, and so is each that is not.
#[test]
fn inspect_lists_the_schemes_that_run() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for scene in [FLUID, SPIN, QUBIT] {
        let orders = found(path, "inspect", scene)["orders"].clone();
        let listed = orders.as_array().unwrap().iter().map(|order| order["scheme"].as_str());
        let mut listed: Vec<&str> = listed.map(Option::unwrap).collect();
        listed.sort_unstable();
        let runs = |scheme: &&str| {
            let few = ["run", "scene.toml", "--scheme", *scheme, "--paths", "1"];
            run(path, &few).status.success()
        };
        let all = BuiltIn::ALL.map(BuiltIn::id);
        let mut able: Vec<&str> = all.into_iter().filter(runs).collect();
        able.sort_unstable();
        assert_eq!(listed, able);
        assert_eq!(listed, ["em", "heun", "midpoint", "sexp-li"]);
    }
}

#[test]
fn mistakes_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let edits = [
        (FLUID, "size = 5", "size = 1", "from 2 to 1024"),
        (FLUID, "degrees = [2]", "degrees = [5]", "from 1 to 4"),
        (
            FLUID,
            "[0, 1, 0]",
            "[0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]",
            "up to 24",
        ),
        (SPIN, "levels = 3", "levels = 4", "4 amplitudes"),
        (SPIN, "transverse = { s = 1 }", "friction = { s = 1 }", "one bath"),
        (
            SPIN,
            "transverse = { s = 1 }",
            "transverse = { s = -1 }",
            "damping must be above 0, got -1",
        ),
        (SPIN, "temperature = ", "temperature = -", "kT must be at least 0, got -"),
        (SPIN, "initial = [1, 0, 0]", "initial = [0, 0, 0]", "must not all be zero"),
        (QUBIT, "\"-i\", \"i\"", "\"i\", \"2*i\"", "entry (2, 1) is 0+2i, that of (1, 2) 0+1i"),
        (QUBIT, "\"-i\", \"i\"", "\"-i\", \"i\", 0", "a square matrix, row by row, got 5"),
        (QUBIT, "[\"g/2\", 0,", "[\"g/2\", 1,", "line 7, column 10: L1 must be Hermitian"),
        (QUBIT, "\"-i\"", "\"-i*i\"", "no number a + b*i"),
        (QUBIT, "noises = [\"g/2\", 0,", "noises = [0,", "4 entries"),
        (QUBIT, "steps = 64", "steps = 64\nscheme = \"sexp-h\"", "take sexp-li"),
    ];
    for (scene, old, new, words) in edits {
        assert!(scene.contains(old), "{old}");
        fs::write(folder.path().join("scene.toml"), scene.replace(old, new)).unwrap();
        let output = run(folder.path(), &["run", "scene.toml"]);
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && text.contains(words), "{new}: {text}");
    }
}
