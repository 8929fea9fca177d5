//! Unfinished work: gone on from with the same bits, and never mixed with that of another scene.

use std::{fs, path::Path};

use serde_json::Value;

use crate::common::{fails, read_json, succeeds, with_scene};
#[cfg(unix)]
use crate::parts::signalled;

/// A double well with something rare.
const WELL: &str = r#"[system]
state = ["q", "p"]
parameters = { heat = 0.6 }
B = "canonical"
H0 = "p^2/2 + (q^2 - 1)^2 / 4"
H = ["heat*q"]
[damping]
rates = { p = 0.3 }
[run]
initial = [1, 0]
until = 8
steps = 256
paths = 25000
[events]
far = "q > 2.5"
[expect]
of = ["q^2"]
accuracy = 2e-3
"#;

/// The JSON of a command without the seconds that it took.
fn result(path: &Path, arguments: &[&str]) -> Value {
    let told = succeeds(path, &[arguments, &["--json"]].concat());
    let mut json: Value = serde_json::from_str(&told).unwrap();
    json.as_object_mut().unwrap().remove("seconds");
    json
}

/// Each verb is stopped, refuses to go on with an edited scene, and goes on with the old one.
#[cfg(unix)]
#[test]
fn what_is_kept_is_of_one_scene() {
    let verbs: [(&[&str], &str); 5] = [
        (&["run", "scene.toml"], "run/part-1-of-1.bin"),
        (&["expect", "scene.toml"], "expect/samples.bin"),
        (&["equilibrium", "scene.toml", "--scheme", "sexp"], "equilibrium/chains.bin"),
        (&["lyapunov", "scene.toml", "--accuracy", "2e-3"], "lyapunov/chains.bin"),
        (&["order", "scene.toml", "--path-steps", "1.5e7"], "order/part-1-of-1.bin"),
    ];
    let rare = "events.far = q>2.5\nand here is\n  events.far = q>2.6\n";
    let edits = [
        ("q > 2.5", "q > 2.6", rare),
        ("heat = 0.6", "heat = 0.61", "system.parameters.heat = 0.61"),
        ("/ 4", "/ 4.0", "system.H0 = p^2/2+(q^2-1)^2/4.0"),
        ("steps = 256", "steps = 512", "run.steps = 512"),
        ("[events]", "truncation = 5\n[events]", "run.truncation = 5"),
    ];
    for ((arguments, file), (old, new, words)) in verbs.into_iter().zip(edits) {
        let folder = with_scene(WELL);
        let path = folder.path();
        // On one thread there is work left after 200 ms, and a busy machine may have done none.
        let alone = [arguments, &["--threads", "1"]].concat();
        let file = path.join(format!("scene-{file}"));
        let mut stopped =
            [200, 400, 800].into_iter().map(|wait| signalled(path, &alone, "-INT", wait));
        let (code, said) = stopped.find(|(_, said)| said.contains("goes on")).unwrap_or_default();
        assert_eq!(code, Some(130), "{arguments:?}: {said}");
        let kept = fs::read(&file).unwrap();
        fs::write(path.join("scene.toml"), WELL.replacen(old, new, 1)).unwrap();
        fails(path, arguments, 1, &["is of another computation", words]);
        assert_eq!(fs::read(&file).unwrap(), kept);
        // What does not change the meaning.
        let same =
            WELL.replace("/ 4\"", "/4\"  # a quarter").replace("paths = 25000", "\npaths=2.5e4");
        fs::write(path.join("scene.toml"), format!("title = \"A well\"\n{same}")).unwrap();
        if let "expect" = arguments[0] {
            let other = [arguments, &["--coarsest-steps", "16"]].concat();
            fails(path, &other, 1, &["is of another computation"]);
        }
        if let "run" | "order" = arguments[0] {
            let found = result(path, arguments);
            assert!(!file.exists());
            assert_eq!(found, result(path, arguments), "{arguments:?}");
        } else {
            // The others go on to the same bits where they are tested.
            let (code, said) = signalled(path, &alone, "-INT", 200);
            assert!(code == Some(130) && said.contains("going on from"), "{code:?}: {said}");
        }
    }
}

#[test]
fn a_damaged_file_is_refused_and_stays() {
    let folder = with_scene(WELL);
    for (verb, file) in [("expect", "samples.bin"), ("equilibrium", "chains.bin")] {
        let kept = folder.path().join(format!("scene-{verb}"));
        fs::create_dir(&kept).unwrap();
        fs::write(kept.join(file), "").unwrap();
        fails(folder.path(), &[verb, "scene.toml"], 1, &["is damaged", file, "move it away"]);
        assert_eq!(fs::read(kept.join(file)).unwrap(), b"");
    }
}

/// A plan is of one scene, too.
#[test]
fn a_plan_that_was_changed_is_refused() {
    let folder = with_scene(&WELL.replace("25000", "300"));
    let path = folder.path();
    succeeds(path, &["plan", "scene.toml", "--parts", "2", "--out", "big"]);
    let part = |number| ["part", "big", "--part", number];
    succeeds(path, &part("1"));
    let (plan, scene) = (path.join("big/plan.json"), path.join("big/scene.toml"));
    let [planned, text] = [&plan, &scene].map(|file| fs::read_to_string(file).unwrap());
    let refused = || {
        for arguments in [&part("2")[..], &["merge", "big"], &["extend", "big", "--paths", "999"]] {
            fails(path, arguments, 2, &["was changed since `casimir plan`"]);
        }
    };
    fs::write(&scene, text.replace("q > 2.5", "q > 2.6")).unwrap();
    refused();
    fs::write(&scene, format!("# A comment.\n{text}")).unwrap();
    for (key, value) in [("parts", "3"), ("paths", "200"), ("settled", r#"[["em", "faster"]]"#)] {
        let mut changed = read_json(&plan);
        changed[key] = serde_json::from_str(value).unwrap();
        fs::write(&plan, changed.to_string()).unwrap();
        refused();
        fs::write(&plan, &planned).unwrap();
    }
    succeeds(path, &part("2"));
    succeeds(path, &["merge", "big"]);
}
