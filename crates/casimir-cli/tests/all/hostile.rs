//! Numbers that are too large, and rates that have no integral: refused before anything is
//! computed, with what would fit, in 4 GB of addresses.

use std::{path::Path, process::Output};

use crate::common::{OSCILLATOR, json, run, succeeds, with_scene};

/// The program in so many megabytes of addresses.
fn confined(folder: &Path, arguments: &str, megabytes: u32) -> Output {
    let program = env!("CARGO_BIN_EXE_casimir");
    let line = format!("ulimit -v {megabytes}000; exec {program} {arguments}");
    let mut command = std::process::Command::new("sh");
    // Without memory the search for line numbers may wait for itself.
    command
        .current_dir(folder)
        .env("RUST_BACKTRACE", "0")
        .args(["-c", &line])
        .output()
        .expect("a shell")
}

/// The oscillator with a line in the place of another.
fn with(line: &str, other: &str) -> String {
    assert!(OSCILLATOR.contains(line), "{line}");
    OSCILLATOR.replace(line, other)
}

fn lattice(sizes: &str) -> String {
    format!(
        "[system]\nname = \"spin-lattice\"\nparameters = {{ sizes = {sizes}, noise = 0.1 }}\n[run]\n\
         initial = [0, 0.6, 0.8]\nuntil = 1\nsteps = 64\n"
    )
}

/// Masses and springs.
fn masses(number: usize) -> String {
    let energies: Vec<String> = (1..=number).map(|k| format!("p{k}^2/2 + q{k}^4/4")).collect();
    let zeros = vec!["0"; 2 * number - 1].join(", ");
    format!(
        "[system]\nstate = [\"q[1..{number}]\", \"p[1..{number}]\"]\nB = \"canonical(q, p)\"\n\
         H0 = \"{}\"\nH = [\"q1\"]\n[run]\ninitial = [1, {zeros}]\nuntil = 1\nsteps = 64\n\
         [observe]\nx = \"q1\"\n",
        energies.join(" + ")
    )
}

/// So many observables, all in pairs.
fn pairs(number: usize) -> String {
    let observables: String = (0..number).map(|k| format!("o{k} = \"q + {k}*p\"\n")).collect();
    let pair = |k: usize| (0..k).map(move |l| format!("[\"o{k}\", \"o{l}\"]"));
    let pairs: Vec<String> = (0..number).flat_map(pair).collect();
    let all = format!("{observables}[statistics]\npairs = [{}]\n", pairs.join(", "));
    with("paths = 4", "paths = 1000")
        .replace("energy = \"H0\"\n", &format!("energy = \"H0\"\n{all}"))
}

#[cfg(target_os = "linux")]
#[test]
fn what_is_too_large_is_refused_before_the_first_step() {
    let friction = with("rate = \"0.1\"", "rates = { p = 1 }");
    let steps = |text: &str| with("steps = 64", text);
    let sweep = |values: &str| format!("{OSCILLATOR}[sweep]\nk = {values}\n");
    let table = [
        (lattice("[1000, 1000, 100]"), "run scene.toml", "a lattice of 100000000 sites would take"),
        (lattice("[1000, 1000]"), "inspect scene.toml", "sites would take about 15.0 GB of memory"),
        (lattice("[1e5]"), "order scene.toml", "paths at a time with 300000 components"),
        (lattice("[1e4]"), "lyapunov scene.toml --count 3000", "256 chains of 30000 components"),
        (masses(75_000), "run scene.toml", "formulas of 150000 components would take about 4.5 GB"),
        (pairs(150), "run scene.toml", "observables and 11175 pairs at 64 times would take"),
        (steps("steps = 1e9\ntimes = 1e9"), "run scene.toml", "1000000001 times would take"),
        (steps("steps = 9007199254740881\ntimes = 1e14"), "run scene.toml", "steps: take 1"),
        (friction.clone(), "equilibrium scene.toml --steps 2e9", "pilot takes 960000000000"),
        (friction.clone(), "equilibrium scene.toml --path-steps 10", "but 10 are allowed"),
        (friction.clone(), "equilibrium scene.toml --chains 1e7", "from 32 to 2^20"),
        (friction, "lyapunov scene.toml --threads 99999999", "1024 are the most"),
        (sweep("[0.1, 0.1]"), "run scene.toml", "`k` has the value 0.1 twice"),
        (sweep("[0.1, \"1/10\"]"), "run scene.toml", "`k` has the value 1/10 twice"),
        (OSCILLATOR.into(), "run scene.toml --set k=0:0:3", "twice"),
        (
            with("\"q\", \"p\"", "\"q[1..100000][1..100000]\""),
            "inspect scene.toml",
            "neither a name",
        ),
        (with("state = [\"q\", \"p\"]", "state = []"), "run scene.toml", "has no component"),
        (
            with("state = [\"q\", \"p\"]", "state = []").replace("[1.0, 0.5]", "[]"),
            "inspect scene.toml",
            "the initial value has no component",
        ),
    ];
    for (scene, arguments, words) in table {
        let folder = with_scene(&scene);
        let output = confined(folder.path(), arguments, 4000);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments}: {message}");
        assert!(message.contains(words), "{arguments}, {words}: {message}");
        assert!(!folder.path().join("scene-run/index.html").exists(), "{arguments}");
    }
}

/// What is not shown or looked for in a large system is said.
#[test]
fn inspect_says_what_it_leaves_out() {
    let told = succeeds(with_scene(&masses(300)).path(), &["inspect", "scene.toml"]);
    assert!(told.contains("dq100 = p100 dt\n  and of 500 more components\n"), "{told}");
    assert!(told.contains("not searched in so large a system"), "{told}");
    assert!(told.contains(" + 296 terms of H0"), "{told}");
}

#[test]
fn chains_that_fail_keep_to_their_path_steps() {
    let fails = with("p^2/2 + k*q^2/2", "p^2/2 + exp(exp(exp(q*q)))");
    let fails = fails.replace("rate = \"0.1\"", "rates = { p = 1 }");
    let folder = with_scene(&fails);
    let output =
        run(folder.path(), &["equilibrium", "scene.toml", "--path-steps", "1e6", "--json"]);
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(found["spent"].as_u64().is_some_and(|spent| spent <= 1_000_000), "{found}");
}

/// What is unusual but fits: a long name, as many values as a sweep may have, many observables with
/// their pairs.
#[cfg(target_os = "linux")]
#[test]
fn what_fits_is_computed() {
    let name = "o".repeat(70_000);
    let named = with("\"q\", \"p\"", &format!("\"{name}\", \"p\""))
        .replace("+ k*q^2/2", &format!("+ k*{name}^2/2"))
        .replace("s*q", &format!("s*{name}"))
        .replace("\"energy\", \"q\"", "\"energy\"");
    let one = with("paths = 4", "paths = 1").replace("steps = 64", "steps = 1");
    let observables: String = (0..150).map(|k| format!("o{k} = \"q + {k}*p\"\n")).collect();
    let ring = (0..150).map(|k| format!("[\"o{k}\", \"o{}\"]", (k + 1) % 150));
    let ring =
        format!("{observables}[statistics]\npairs = [{}]\n", ring.collect::<Vec<_>>().join(", "));
    let ring = with("paths = 4", "paths = 200")
        .replace("energy = \"H0\"\n", &format!("energy = \"H0\"\n{ring}"));
    for (scene, arguments, megabytes) in [
        (named, "run scene.toml", 4000),
        (one, "run scene.toml --threads 2 --set k=0:1:400", 400),
        (ring, "run scene.toml --threads 2", 800),
    ] {
        let output = confined(with_scene(&scene).path(), arguments, megabytes);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{arguments}: {message}");
    }
}

#[test]
fn hundreds_of_noises_are_inspected() {
    let noises: Vec<String> = (1..=500).map(|k| format!("\"0.001*sin({k}*q)\"")).collect();
    let scene = with("H = [\"s*q\"]", &format!("H = [{}]", noises.join(", ")));
    let found = json(with_scene(&scene).path(), &["inspect", "scene.toml", "--json"]);
    assert_eq!(found["noise"]["commute"]["status"], "holds", "{}", found["noise"]);
}

/// About 1/t^a a rate has an integral for a < 1; then it is simulated, and inspected without a
/// mistake.
#[test]
fn a_rate_needs_an_integral() {
    for (rate, t) in [
        ("1/(t - 1)", "t = 1"),
        ("-1/(t - 1)", "t = 1"),
        ("0.1/abs(t - 1)", "t = 1"),
        ("1/(t - 1)^2", "t = 1"),
        ("1/(t - 0.7)", "t = 0.7"),
        ("1 + 1e-3/(t - 1/3)", "t = 0.333"),
        ("tan(t)", "t = 1.571"),
        ("exp(1e4*t*(2 - t))", "t = 0."),
    ] {
        for damping in [format!("rate = \"{rate}\""), format!("rates = {{ p = \"{rate}\" }}")] {
            let folder = with_scene(&with("rate = \"0.1\"", &damping));
            let output = run(folder.path(), &["run", "scene.toml"]);
            let message = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{damping}: {message}");
            let words = format!("has no integral about {t}");
            assert!(message.contains(&words), "{damping}, {words}: {message}");
        }
    }
    for rate in [
        "1/sqrt(abs(t - 1))",
        "1/sqrt(abs(t - 0.7))",
        "0.1/abs(t - 1)^0.9",
        "ln(abs(t - 1/3))",
        "if(t > 1/3, 5, -1)",
        "1000*exp(-(1e5*(t - 0.71))^2)",
        "sin(1e6*t)",
    ] {
        let folder = with_scene(&with("rate = \"0.1\"", &format!("rate = \"{rate}\"")));
        json(folder.path(), &["run", "scene.toml", "--json"]);
        let found = json(folder.path(), &["inspect", "scene.toml", "--json"]);
        assert_eq!(found["mistakes"].as_array().unwrap().len(), 0, "{rate}: {found}");
    }
}
