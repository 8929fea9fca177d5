//! One scene at several values of its parameters.

use std::fs;

use serde_json::{Value, json};

use crate::common::{OSCILLATOR, fails, json as run_json, npz, read_json, succeeds, with_scene};

/// Many paths, two parameters.
fn study() -> String {
    OSCILLATOR.replace("paths = 4", "paths = 300")
}

fn runs(summary: &Value) -> &[Value] {
    summary["runs"].as_array().expect("runs")
}

#[test]
fn each_combination_is_a_run_of_its_own() {
    let folder = with_scene(&(study() + "\n[sweep]\nk = \"0.5:1.5:3\"\n"));
    let path = folder.path();
    let sweep = run_json(path, &["run", "scene.toml", "--set", "s=0.2,1/4", "--json"]);
    assert_eq!(sweep["sweep"], json!({ "k": [0.5, 1.0, 1.5], "s": [0.2, 0.25] }));
    assert_eq!(runs(&sweep).len(), 6);
    // The last one changes fastest.
    assert_eq!(runs(&sweep)[1]["parameters"], json!({ "k": 0.5, "s": 0.25 }));
    let other = ["run", "scene.toml", "--set", "s=0.2,1/4", "--independent", "--json"];
    let other = run_json(path, &other);
    for (n, (run, other)) in runs(&sweep).iter().zip(runs(&other)).enumerate() {
        let [k, s] = ["k", "s"].map(|name| format!("{name}={}", run["parameters"][name]));
        let alone = run_json(path, &["run", "scene.toml", "--set", &k, "--set", &s, "--json"]);
        for key in ["at_end", "step_check", "scheme", "paths"] {
            assert_eq!(run[key], alone[key], "{k}, {s}: {key}");
        }
        // The same numbers for the first, others for the rest.
        assert_eq!(run["at_end"] == other["at_end"], n == 0);
    }
    succeeds(path, &["run", "scene.toml", "--write", "csv,npz,json"]);
    let csv = fs::read_to_string(path.join("scene-run/sweep.csv")).unwrap();
    let begin = "k,t,observable,quantity,value,lo,hi,note\n0.5,0.0,energy,count,300,,,\n";
    assert!(csv.starts_with(begin), "{csv}");
    let means = csv.lines().filter(|line| line.contains(",mean,"));
    assert_eq!(means.count(), 3 * 3 * 65);
    let bytes = fs::read(path.join("scene-run/sweep.npz")).unwrap();
    let has = |words: &str| bytes.windows(words.len()).any(|window| window == words.as_bytes());
    assert!(has("energy mean.npy") && has("'shape': (3, 65)"));
    let written = read_json(path.join("scene-run/sweep.json"));
    assert_eq!(written["runs"][2]["parameters"]["k"], 1.5);
    assert_eq!(written["runs"][2]["series"][0]["observable"], "energy");
    let page = fs::read_to_string(path.join("scene-run/index.html")).unwrap();
    assert!(page.contains("against k") && page.contains("the same for each combination"));
    // Arrays have an axis for each parameter, the last one fastest, and that of time.
    succeeds(path, &["run", "scene.toml", "--set", "s=0.2,1/4", "--write", "npz,json"]);
    let written = read_json(path.join("scene-run/sweep.json"));
    let means = npz(path.join("scene-run/sweep.npz"), "energy mean");
    assert_eq!(means.len(), 3 * 2 * 65);
    for (run, means) in runs(&written).iter().zip(means.chunks(65)) {
        assert_eq!(run["series"][0]["points"][64]["mean"], means[64]);
    }
    // A few paths have no intervals.
    let few = succeeds(path, &["run", "scene.toml", "--paths", "2", "--write", "csv,npz"]);
    assert!(few.contains("k = 1.5  energy"), "{few}");
}

#[test]
fn a_sweep_in_parts_has_the_bits_of_a_whole_one() {
    let folder = with_scene(&study());
    let path = folder.path();
    let set = ["--set", "k=1,2", "--set", "s=0.1,0.3"];
    succeeds(path, &[&["plan", "scene.toml", "--parts", "3", "--out", "big"], &set[..]].concat());
    for part in ["3", "1", "2"] {
        succeeds(path, &["part", "big", "--part", part]);
    }
    let write = ["--write", "csv,npz,json"];
    succeeds(path, &[&["merge", "big"], &write[..]].concat());
    succeeds(path, &[&["run", "scene.toml"], &write[..], &set].concat());
    for name in ["sweep.csv", "sweep.npz", "sweep.json"] {
        let [one, other] =
            ["big", "scene-run"].map(|of| fs::read(path.join(of).join(name)).unwrap());
        assert!(one == other, "{name}");
    }
}

#[test]
fn what_cannot_be_varied_is_named() {
    let folder = with_scene(OSCILLATOR);
    let path = folder.path();
    for (set, words) in [
        ("kk=1,2", &["no parameter `kk`", "there are k, s"][..]),
        ("k=1,x", &["k = x: unknown name `x`"]),
        ("k=1/0", &["k = 1/0"]),
        ("k", &["NAME=VALUE"]),
        ("k=0:1", &["from:to:number"]),
        ("k=0:b:3", &["`b`", "is not a number"]),
        ("k=0:1:1e9", &["too many"]),
        ("k=", &["k = "]),
    ] {
        fails(path, &["run", "scene.toml", "--set", set], 2, words);
    }
    fails(path, &["run", "scene.toml", "--set", "k=1", "--set", "k=2"], 2, &["twice"]);
    // Facts are of one scene.
    fails(path, &["inspect", "scene.toml", "--set", "k=1,2"], 2, &["choose it by --set k=1"]);
    assert!(!path.join("scene-run").exists());
    // `inspect` takes the value that the parameter has.
    let folder = with_scene(&(OSCILLATOR.to_owned() + "\n[sweep]\nk = [1, 2]\n"));
    succeeds(folder.path(), &["inspect", "scene.toml"]);
    let folder = with_scene(&(OSCILLATOR.to_owned() + "\n[sweep]\nz = [1, 2]\n"));
    fails(folder.path(), &["run", "scene.toml"], 2, &["line", "no parameter `z`", "z = [1, 2]"]);
}

/// E[q] = e^{−s²T/2}cos wT and its derivative by w, at each combination, with files and unfinished
/// work of its own; one has the bits of a scene alone.
#[test]
fn verbs_vary_what_is_varied() {
    let kubo = "[system]\nstate = [\"q\", \"p\"]\nB = [[\"1\"]]\nH0 = \"w*(q^2 + p^2)/2\"\n\
                H = [\"s*(q^2 + p^2)/2\"]\nparameters = { w = 1, s = 0.3 }\n[run]\n\
                initial = [1, 0]\nuntil = 1\nsteps = 64\n[expect]\nof = [\"q\"]\n\
                accuracy = 1e-3\n[sweep]\nw = [0.5, \"3/2\"]\n";
    let folder = with_scene(kubo);
    let path = folder.path();
    let list = run_json(
        path,
        &["expect", "scene.toml", "--gradient", "w", "--set", "s=0.2,0.4", "--json"],
    );
    let list = list.as_array().expect("a list");
    assert_eq!(list.len(), 4);
    for (k, one) in list.iter().enumerate() {
        let [w, s]: [f64; 2] = ["w", "s"].map(|name| one["parameters"][name].as_f64().unwrap());
        assert_eq!([w, s], [[0.5, 1.5][k / 2], [0.2, 0.4][k % 2]]);
        let decay = (-0.5 * s * s).exp();
        let found = [&one["estimates"][0], &one["gradient"]["w"][0]];
        for (found, truth) in found.into_iter().zip([decay * w.cos(), -decay * w.sin()]) {
            let [value, half] = ["value", "half_width"].map(|key| found[key].as_f64().unwrap());
            // Five half-widths, 9.8 deviations.
            assert!((value - truth).abs() < 5.0 * half && half < 1e-2, "{found} {truth}");
        }
        let written =
            read_json(path.join(format!("scene-expect/combination-{}/expect.json", k + 1)));
        assert_eq!(written["estimates"], one["estimates"]);
    }
    let alone = ["--set", "w=1.5", "--set", "s=0.4", "--gradient", "w", "--json", "--out", "alone"];
    let alone = run_json(path, &[&["expect", "scene.toml"][..], &alone].concat());
    assert_eq!(alone["estimates"], list[3]["estimates"]);
    // Those that fail are all named, and the others are there.
    let few = ["equilibrium", "scene.toml", "--accuracy", "1e-9", "--path-steps", "1e6"];
    fails(path, &few, 1, &["error: w = 0.5: ±1e-9 not reached", "\nw = 3/2: ±1e-9 not reached"]);
    let text = succeeds(path, &["order", "scene.toml"]);
    assert!(text.contains("== w = 0.5\n") && text.contains("== w = 3/2\n"), "{text}");
    assert!(path.join("scene-order/combination-2/strong.svg").exists());
}
