//! Random initial values.

use std::fs;

use crate::common::{fails, json, read_json, succeeds, with_scene};

/// q + ip turns by t + W(t)/2 and shrinks by e^{−t/10}.
const KUBO: &str = r#"[system]
state = ["q", "p"]
parameters = { w = 0.5 }
B = [["1"]]
H0 = "(q^2 + p^2)/2"
H = ["0.5*(q^2 + p^2)/2"]
[damping]
rate = 0.1
[run]
initial = ["1 + w*z1", "u1 - 0.5"]
until = 2
steps = 64
paths = 4000
[expect]
of = ["q", "q^2"]
accuracy = 3e-3
"#;

/// E[q(2)] and E[q(2)²] for E[q₀] = 1, E[p₀] = 0, E[q₀²] = 1 + w², E[p₀²] = 1/12.
fn truth() -> [f64; 2] {
    let (shrunk, turned) = ((-0.2f64).exp(), (-0.25f64).exp());
    // E cos²(t + W/2) = (1 + e^{−t/2}cos 2t)/2.
    let cos2 = 0.5 * (1.0 + (-1.0f64).exp() * 4f64.cos());
    let square = 1.25 * cos2 + (1.0 - cos2) / 12.0;
    [shrunk * turned * 2f64.cos(), shrunk * shrunk * square]
}

#[test]
fn statistics_are_over_initial_values_too() {
    let folder = with_scene(KUBO);
    let path = folder.path();
    succeeds(path, &["run", "scene.toml", "--write", "json,csv"]);
    let study = read_json(path.join("scene-run/study.json"));
    // Their own moments at time 0: four standard errors, and exact extremes of a uniform number.
    let start = |k: usize, key: &str| study["series"][k]["points"][0][key].as_f64().unwrap();
    let root = 4000f64.sqrt();
    assert!((start(0, "mean") - 1.0).abs() < 4.0 * 0.5 / root);
    assert!((start(0, "variance") - 0.25).abs() < 4.0 * 0.25 * 2f64.sqrt() / root);
    assert!(start(1, "mean").abs() < 4.0 / (root * 12f64.sqrt()));
    // The variance of (u − ½)² is 1/180.
    assert!((start(1, "variance") - 1.0 / 12.0).abs() < 4.0 / (root * 180f64.sqrt()));
    assert!(start(1, "least") > -0.5 && start(1, "largest") < 0.5);
    assert_eq!(study["series"][0]["points"].as_array().unwrap().len(), 65);
    // Each path is on the law of its own energy.
    let tables = read_json(path.join("scene-run/paths.json"));
    for table in tables.as_array().unwrap() {
        let defects = &table["columns"].as_array().unwrap().last().unwrap()["values"];
        assert!(
            defects.as_array().unwrap().iter().all(|defect| defect.as_f64().unwrap().abs() < 1e-13)
        );
    }
    let found = json(path, &["expect", "scene.toml", "--json"]);
    for (k, truth) in truth().into_iter().enumerate() {
        let estimate = &found["estimates"][k];
        let [lo, hi] = ["lo", "hi"].map(|end| estimate[end].as_f64().unwrap());
        // An interval misses once in twenty times; twice as wide, it does in 10⁴.
        let (middle, width) = (0.5 * (lo + hi), hi - lo);
        assert!((middle - truth).abs() < width, "{middle} ± {width}: {truth}");
        let run = study["series"][0]["points"][64]["mean_interval"].clone();
        let [lo, hi] = serde_json::from_value::<[f64; 2]>(run).unwrap();
        assert!(k > 0 || (0.5 * (lo + hi) - truth).abs() < hi - lo);
    }
}

#[test]
fn random_initial_values_have_fixed_bits() {
    let folder = with_scene(KUBO);
    let path = folder.path();
    let write = ["--write", "csv,npz,json"];
    succeeds(path, &[&["run", "scene.toml", "--threads", "1"], &write[..]].concat());
    succeeds(path, &["plan", "scene.toml", "--parts", "2", "--out", "big"]);
    for part in ["2", "1"] {
        succeeds(path, &["part", "big", "--part", part]);
    }
    succeeds(path, &[&["merge", "big"], &write[..]].concat());
    for name in ["study.csv", "study.json", "study.npz", "paths.csv"] {
        let [one, other] =
            ["big", "scene-run"].map(|of| fs::read(path.join(of).join(name)).unwrap());
        assert!(one == other, "{name}");
    }
    // Without noise and with one path, too.
    let silent = KUBO.replace("H = [\"0.5*(q^2 + p^2)/2\"]\n", "");
    let folder = with_scene(&silent);
    let found = json(folder.path(), &["expect", "scene.toml", "--json"]);
    let exact = (-0.2f64).exp() * 2f64.cos();
    let value = found["estimates"][0]["value"].as_f64().unwrap();
    assert!((value - exact).abs() < 6e-3, "{value} {exact}");
    let said = succeeds(folder.path(), &["run", "scene.toml", "--paths", "2"]);
    assert!(said.contains("path 1"), "{said}");
    for (wrong, words) in [("ln(z1)", "must be finite"), ("z99", "unknown name `z99`")] {
        let folder = with_scene(&KUBO.replace("u1 - 0.5", wrong));
        fails(folder.path(), &["run", "scene.toml"], 2, &["line", words]);
    }
}

/// A parameter may have the name of a random number, and three formulas stand for all spins.
#[test]
fn spins_have_random_numbers_of_their_own() {
    let length = "sqrt(z1^2 + z2^2 + z3^2)";
    let text = format!(
        "[system]\nname = \"spin-lattice\"\nparameters = {{ sizes = [20] }}\n[run]\n\
         initial = [\"z1/{length}\", \"z2/{length}\", \"z3/{length}\"]\nuntil = 0.1\nsteps = 4\n\
         [observe]\nunlike = \"s1x - s2x\"\nfirst = \"sqrt(s1x^2 + s1y^2 + s1z^2)\"\n"
    );
    let folder = with_scene(&text);
    succeeds(folder.path(), &["run", "scene.toml", "--write", "json"]);
    let tables = read_json(folder.path().join("scene-run/paths.json"));
    let columns = tables[0]["columns"].as_array().unwrap();
    let first = |name: &str| {
        let column = columns.iter().find(|column| column["name"] == name).unwrap();
        column["values"][0].as_f64().unwrap()
    };
    assert!(first("unlike").abs() > 1e-3 && (first("first") - 1.0).abs() < 1e-14);
    // All of them are in the magnetization.
    let text = text.replace("[20]", "[2]").replace(
        "unlike = \"",
        "off = \"mx - s1x/2 - s2x/2 + my - s1y/2 - s2y/2 + mz - s1z/2 - s2z/2\"\nunlike = \"",
    );
    let folder = with_scene(&text);
    succeeds(folder.path(), &["run", "scene.toml", "--write", "json"]);
    let tables = read_json(folder.path().join("scene-run/paths.json"));
    let columns = tables[0]["columns"].as_array().unwrap();
    let off = columns.iter().find(|column| column["name"] == "off").unwrap();
    let off: Vec<f64> = serde_json::from_value(off["values"].clone()).unwrap();
    assert!(off.len() == 5 && off.iter().all(|off| off.abs() < 1e-14), "{off:?}");
    let folder = with_scene(&KUBO.replace("w = 0.5", "w = 0.5, z1 = 2.0").replace("u1 - 0.5", "0"));
    let said = succeeds(folder.path(), &["run", "scene.toml", "--paths", "1", "--write", "json"]);
    assert!(said.contains("path 0"));
    let tables = read_json(folder.path().join("scene-run/paths.json"));
    assert_eq!(tables[0]["columns"][1]["values"][0], 2.0);
}

/// The midpoint rule turns by 2 arctan(τ/2) for τ: over initial values with E|y|² = 2, the root
/// mean square of its errors is √8 times the sine of half of what is lacking.
#[test]
fn schemes_are_compared_over_initial_values() {
    let silent =
        KUBO.replace("H = [\"0.5*(q^2 + p^2)/2\"]\n", "").replace("rate = 0.1", "rate = 0");
    let folder = with_scene(&silent.replace("\"1 + w*z1\", \"u1 - 0.5\"", "\"z1\", \"z2\""));
    let found = json(folder.path(), &["compare", "scene.toml", "--budget", "0.3", "--json"]);
    let candidates = found["candidates"].as_array().unwrap();
    let sexp = candidates.iter().find(|one| one["scheme"] == "sexp").unwrap();
    let point = &sexp["points"][0];
    let [steps, lo, hi] = ["steps", "lo", "hi"].map(|key| point[key].as_f64().unwrap_or(f64::NAN));
    let exact = 8f64.sqrt() * (1.0 - steps * (1.0 / steps).atan()).sin();
    // An interval of 95 % that is three times as wide misses once in 10⁸.
    assert!(lo < hi && lo - (hi - lo) < exact && exact < hi + (hi - lo), "{exact}: {point}");
}

/// Paths take the states of a file in turn; expectations take them at random.
#[test]
fn a_file_has_initial_states() {
    let states: Vec<[f64; 2]> =
        (0..5).map(|k| [1.0 + f64::from(k), 0.5 * f64::from(k * k)]).collect();
    let line = |state: &[f64; 2]| format!("{}, {}\n", state[0], state[1]);
    let text = states.iter().map(line).collect::<String>();
    let scene = KUBO.replace("[\"1 + w*z1\", \"u1 - 0.5\"]", "\"states.csv\"");
    let scene = scene.replace("\"q\", \"q^2\"", "\"q\"").replace("3e-3", "0.02");
    let folder = with_scene(&scene);
    let path = folder.path();
    fs::write(path.join("states.csv"), format!("q, p\n# five\n{text}")).unwrap();
    succeeds(path, &["run", "scene.toml", "--paths", "7", "--write", "json"]);
    let tables = read_json(path.join("scene-run/paths.json"));
    for (k, table) in tables.as_array().unwrap().iter().enumerate() {
        for (i, name) in ["q", "p"].iter().enumerate() {
            let columns = table["columns"].as_array().unwrap();
            let column = columns.iter().find(|column| column["name"] == *name).unwrap();
            assert_eq!(column["values"][0].as_f64().unwrap(), states[k % 5][i]);
        }
    }
    let mean = |f: &dyn Fn(&[f64; 2]) -> f64| states.iter().map(f).sum::<f64>() / 5.0;
    let (shrunk, turned) = ((-0.2f64).exp(), (-0.25f64).exp());
    let truth = shrunk * turned * (2f64.cos() * mean(&|y| y[0]) + 2f64.sin() * mean(&|y| y[1]));
    let found = json(path, &["expect", "scene.toml", "--json"]);
    let estimate = &found["estimates"][0];
    let (lo, hi) = (estimate["lo"].as_f64().unwrap(), estimate["hi"].as_f64().unwrap());
    assert!(lo < truth && truth < hi, "{truth}: {estimate}");
    // Parts have the file too.
    succeeds(path, &["plan", "scene.toml", "--parts", "2", "--out", "parts"]);
    for part in ["1", "2"] {
        succeeds(path, &["part", "parts", "--part", part]);
    }
    succeeds(path, &["merge", "parts", "--write", "npz"]);
    succeeds(path, &["run", "scene.toml", "--write", "npz"]);
    let npz = |folder: &str| fs::read(path.join(folder).join("study.npz")).unwrap();
    assert!(npz("parts") == npz("scene-run"));

    for (content, words) in [
        ("", "states.csv has no state"),
        ("1, 2\n3\n", "line 2 of states.csv is no state: 3"),
        ("1, 2\n3, x\n", "line 2 of states.csv is no state"),
        ("1, 2\n3, inf\n", "line 2 of states.csv is no state"),
        ("1, 2, 3\n", "the initial value must have 2 components, got 3"),
    ] {
        fs::write(path.join("states.csv"), content).unwrap();
        fails(path, &["run", "scene.toml", "--out", "wrong"], 2, &[words]);
    }
    fs::remove_file(path.join("states.csv")).unwrap();
    fails(
        path,
        &["run", "scene.toml", "--out", "wrong"],
        2,
        &["cannot read the states states.csv"],
    );
    assert!(!path.join("wrong").exists());
}
