//! Lattices of scenes: cells, materials, fields, and paths of very many spins.

use std::{fs, path::Path, process::Command, thread::sleep, time::Duration};

use crate::common::{casimir, fails, json, npz, run, succeeds, with_scene};

/// A scene of a lattice with parameters, and what follows.
fn scene(parameters: &str, rest: &str) -> String {
    format!("[system]\nname = \"spin-lattice\"\n[system.parameters]\n{parameters}\n{rest}\n")
}

const HOT: &str = "[bath]\ntemperature = 0.3\ntransverse = { s1 = 0.1, s2 = 0.4 }";

/// A hexagonal close-packed magnet of two materials.
fn two_materials(run: &str) -> String {
    let parameters = "lattice = \"hcp\"\nsizes = [2, 1]\nexchange = [1, -0.5, 0.6]\n\
                      next = 0.1\ndmi = 0.2\ninterfacial = [0, 0.1, 0]\nmoment = [1, 2]\n\
                      anisotropy = [0.2, -0.1]\nfield = [0.1, 0, 0.3]";
    scene(parameters, &format!("{HOT}\n{run}"))
}

#[test]
fn spins_that_begin_by_their_places_are_not_random() {
    let scene = |initial: &str| {
        format!(
            "[system]\nname = \"spin-lattice\"\n[system.parameters]\nsizes = [8]\n[run]\n\
             initial = [{initial}]\nuntil = 2\nsteps = 200\n[expect]\nof = [\"s3z\"]\n\
             accuracy = 1e-6\n"
        )
    };
    let written = (0..8).map(|x| format!("\"cos({x})\", \"sin({x})\", 0.5"));
    let written = scene(&written.collect::<Vec<_>>().join(", "));
    let [by_place, written] = [scene("\"cos(x)\", \"sin(x)\", 0.5"), written].map(|scene| {
        let folder = with_scene(&scene);
        let found = json(folder.path(), &["expect", "scene.toml", "--json"]);
        let said = crate::common::run(folder.path(), &["inspect", "scene.toml"]).stdout;
        let said = String::from_utf8(said).unwrap();
        let bound = said.lines().find(|line| line.contains("‖y‖ ≤")).map(str::to_owned);
        (found["estimates"][0].clone(), bound)
    });
    assert!(by_place.1.is_some() && by_place == written, "{by_place:?} {written:?}");
    // Of random values no bound is known.
    let folder = with_scene(&scene("\"cos(x + z1)\", \"sin(x + z1)\", 0.5"));
    let said = crate::common::run(folder.path(), &["inspect", "scene.toml"]).stdout;
    let said = String::from_utf8(said).unwrap();
    assert!(said.contains("no bound was found"), "{said}");
}

/// The bath of all spins has the temperature of the scene, by the generator at 32 points, whatever
/// their moments and dampings are. Noise for other moments is refused.
#[test]
fn two_materials_are_at_the_temperature() {
    let run = "[run]\ninitial = [0, 0.6, 0.8]\nuntil = 1\nsteps = 64";
    let folder = with_scene(&two_materials(run));
    let found = json(folder.path(), &["inspect", "scene.toml", "--json"]);
    let beta = found["bath"]["beta"].as_f64().expect("a temperature");
    assert!((0.3 * beta - 1.0).abs() < 1e-9, "{beta}");
    // The noise of moments of one.
    let own = "transverse = [0.1, 0.4]\nnoise = [0.2449489742783178, 0.4898979485566356]";
    let text = two_materials(run).replace(HOT, "").replace("moment =", &format!("{own}\nmoment ="));
    let folder = with_scene(&text);
    let found = json(folder.path(), &["inspect", "scene.toml", "--json"]);
    assert!(found["bath"]["beta"].is_null(), "{}", found["bath"]);
}

/// Free spins turn by ∫h dt about z: h = cos t + x/2 at place x.
/// A field that aliases with the steps is named, and also a pulse on one spin; a slow one is not,
/// nor what is negligible beside the exchange.
#[test]
fn fields_that_steps_do_not_resolve_are_named() {
    for (field, resolved) in [
        ("cos(2*pi*800*t)", false),
        ("if(x > 2.5, cos(2*pi*800*t), 0)", false),
        ("cos(2*pi*t)", true),
        ("1e-9*cos(2*pi*800*t)", true),
    ] {
        let parameters = format!("sizes = [4]\nexchange = 1\nfield = [0, 0, \"{field}\"]");
        let run = "[run]\npaths = 1\ninitial = [0, 0.6, 0.8]\nuntil = 1\nsteps = 100";
        let folder = with_scene(&scene(&parameters, run));
        let found = json(folder.path(), &["run", "scene.toml", "--json"]);
        let unresolved = &found["step_check"]["unresolved"];
        assert_eq!(unresolved.is_null(), resolved, "{field}: {unresolved}");
    }
}

#[test]
fn fields_depend_on_time_and_place() {
    let parameters = "sizes = [4]\nexchange = 0\nfield = [0, 0, \"cos(t) + x/2\"]\nmoment = 2";
    let run = "[run]\npaths = 1\ninitial = [\"cos(x)\", \"sin(x)\", 0]\nuntil = 1\nsteps = 1000\n\
               scheme = \"sexp-li\"\ntimes = 1\ncolumns = [\"components\"]";
    let folder = with_scene(&scene(parameters, run));
    succeeds(folder.path(), &["run", "scene.toml", "--write", "npz"]);
    let spins = npz(folder.path().join("scene-run/paths.npz"), "spins");
    for x in 0..4 {
        // ds = s × ∇H₀ = −s × h.
        let angle = f64::from(x) + 1f64.sin() + 0.5 * f64::from(x);
        let found = &spins[12 + 3 * x as usize..][..3];
        for (found, expected) in found.iter().zip([2.0 * angle.cos(), 2.0 * angle.sin(), 0.0]) {
            // A step turns by an angle that is too small by (hτ)³/12, hτ < 0.003.
            assert!((found - expected).abs() < 1e-5, "{x}: {found} {expected}");
        }
    }
}

/// 33 792 spins, of which the last group is not full of one site of the cell.
fn many(steps: u64) -> String {
    let parameters = "lattice = \"bcc\"\nsizes = [33, 32, 16]\nperiodic = true\nmoment = [1, 2]\n\
                      field = [0, 0, \"0.1*cos(t)\"]";
    let run = "[run]\ninitial = [\"z1\", \"cos(2*pi*x)\", 0.5]\nuntil = 0.5\npaths = 2\ntimes = 10\n\
               snapshots = 2\n[observe]\nm = \"sqrt(mx^2 + my^2 + mz^2)\"";
    let bath = "noise = 0.1\ntransverse = [0.1, 0.4]\n";
    scene(&format!("{parameters}\n{bath}"), &format!("{run}\n"))
        .replace("until", &format!("steps = {steps}\nuntil"))
}

/// All files of results with numbers, in order.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let read = fs::read_dir(folder.join("scene-run")).expect("results");
    let mut all: Vec<_> = read
        .map(|file| file.expect("a file"))
        .filter(|file| file.path().extension().is_some_and(|of| of == "npz" || of == "csv"))
        .map(|file| {
            let name = file.file_name().to_string_lossy().into_owned();
            (name, fs::read(file.path()).expect("a file"))
        })
        .collect();
    all.sort();
    all
}

/// Interrupted by Ctrl-C or killed several times, a path of many spins ends with the files of an
/// undisturbed one.
#[cfg(unix)]
#[test]
fn many_spins_go_on_after_a_stop_and_a_kill() {
    let arguments = ["run", "scene.toml", "--write", "npz,csv"];
    let whole = with_scene(&many(40));
    succeeds(whole.path(), &[&arguments[..], &["--threads", "1"]].concat());
    let expected = files(whole.path());
    // Tables, and three snapshots of each path; no checkpoint.
    assert_eq!(expected.len(), 2 + 6);
    let spins = npz(whole.path().join("scene-run/spins-1-20.npz"), "spins");
    assert_eq!(spins.len(), 3 * 33_792);
    for (name, x) in [("correlation-1", "distance in cells"), ("structure-3", "wave number, in")] {
        let file = whole.path().join(format!("scene-run/figures/spectrum-{name}.svg"));
        let figure = fs::read_to_string(file).expect("a figure");
        assert!(figure.contains(x) && figure.contains("t = 0.25"), "{figure}");
    }
    let folder = with_scene(&many(40));
    for (k, signal) in ["-INT", "-KILL", "-INT", "-TERM"].into_iter().enumerate() {
        let mut child = casimir(folder.path()).args(arguments).spawn().expect("it starts");
        sleep(Duration::from_millis(150 + 100 * k as u64));
        Command::new("kill").args([signal, &child.id().to_string()]).status().expect("a signal");
        child.wait().expect("it ends");
    }
    succeeds(folder.path(), &arguments);
    assert_eq!(files(folder.path()), expected);
}

#[test]
fn many_spins_are_for_run_alone() {
    let folder = with_scene(&many(40));
    let words = ["a few paths are not divided"];
    let plan = ["plan", "scene.toml", "--parts", "2", "--out", "parts"];
    fails(folder.path(), &plan, 2, &words);
    let integral = many(40).replace("\"sqrt(", "\"integral(mx)\"\nn = \"sqrt(");
    let folder = with_scene(&integral);
    fails(folder.path(), &["run", "scene.toml"], 2, &["are not collected"]);
}

#[test]
fn wrong_lattices_are_refused() {
    let run_table = "[run]\ninitial = [0, 0, 1]\nuntil = 1\nsteps = 10";
    for (parameters, words) in [
        ("dipolar = 0.1", "dipolar fields are not computed"),
        ("lattice = \"bbc\"", "no lattice `bbc`; there are cubic, bcc"),
        ("lattice = 3", "no lattice `3`"),
        ("lattice = \"bcc\"\nexchange = [1, 2]", "`exchange` takes 1 or 3 numbers here, got 2"),
        ("moment = [1, 2]", "`moment` takes 1 numbers here, got 2"),
        ("field = [0, 0, \"cos(q)\"]", "unknown name `q`"),
        ("field = [0, 0, \"1/t\"]", "at t = 0 and the origin"),
        ("next = 1\nsizes = [4]\nperiodic = true", "take at least 5"),
    ] {
        let folder = with_scene(&scene(parameters, run_table));
        fails(folder.path(), &["run", "scene.toml"], 2, &[words]);
    }
    let few = with_scene(&scene("sizes = [4]", &format!("{run_table}\nsnapshots = 2")));
    fails(few.path(), &["run", "scene.toml"], 2, &["of at least 32768 spins"]);
    let odd = with_scene(&scene("sizes = [4]", &format!("{run_table}\ntimes = 10\nsnapshots = 3")));
    fails(odd.path(), &["run", "scene.toml"], 2, &["3 snapshots do not divide 10 times"]);
    let bath = "[bath]\ntemperature = 1\ntransverse = { s1 = 0.1, s3 = 0.2 }";
    let parameters = "lattice = \"bcc\"\nsizes = [2, 2, 2]";
    let wrong = with_scene(&scene(parameters, &format!("{bath}\n{run_table}")));
    fails(wrong.path(), &["run", "scene.toml"], 2, &["or s1 to s2 for the sites of a cell"]);
    let output = run(few.path(), &["new", "--list"]);
    assert!(String::from_utf8_lossy(&output.stdout).contains("dmi, interfacial, moment"));
}

/// q turns by too small an angle in each step of the midpoint rule, τ³/12, with ¾ of that beside
/// half the step: over T the difference of q is ¾T τ²/12 |p|, of which blocks show a thirtieth.
#[test]
fn a_long_path_is_checked_by_blocks_of_time() {
    let text = "[system]\nstate = [\"q\", \"p\"]\nB = \"canonical\"\nH0 = \"(q^2 + p^2)/2\"\n\
                [run]\ninitial = [1, 0]\nuntil = 1000\nsteps = 100_000\nscheme = \"sexp\"\n";
    let check = |text: &str| {
        let folder = with_scene(text);
        json(folder.path(), &["run", "scene.toml", "--json"])["step_check"].clone()
    };
    let found = check(text);
    let blocks = found["blocks"].as_f64().expect("blocks of time");
    assert!((blocks - 33.32).abs() < 1e-9 && found["paths"] == 32, "{found}");
    let along = found["observables"][0]["along_paths"].as_f64().expect("a number");
    let expected = 0.75 * 1000.0 * 1e-4 / 12.0 / 2f64.sqrt();
    // A mean square of |p| over 32 places, and powers of a growth between blocks of half a turn.
    assert!((along / expected - 1.0).abs() < 0.3, "{along} {expected}");
    // The whole of a shorter path, and of one that time changes.
    for (old, new) in [("100_000", "99_000"), ("(q^2 + p^2)/2", "(q^2 + p^2)/2 + 0.1*cos(t)*q")] {
        assert!(check(&text.replace(old, new))["blocks"].is_null(), "{new}");
    }
}
