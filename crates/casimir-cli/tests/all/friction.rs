//! Friction on some components, and heat baths.

use std::fs;

use crate::common::{fails, json, succeeds, with_scene, without_bath};

/// Two pendulums with a spring in a bath, each with friction of its own.
const PENDULUMS: &str = r#"
[system]
state = ["q[1..2]", "p[1..2]"]
B = "canonical"
H0 = "p1^2/2 + p2^2/(2*m) + 2 - cos(q1) - cos(q2) + (q1 - q2)^2/2"
parameters = { g = 0.7, h = 0.3, kT = 1.5, m = 2.5 }
[bath]
friction = { p1 = "g", p2 = "h" }
temperature = "kT"
[run]
initial = [0.5, 0, 0.1, 0.2]
until = 4
steps = 64
paths = 200
[expect]
of = ["p2"]
accuracy = 0.1
"#;

fn changed(from: &str, to: &str) -> String {
    assert!(PENDULUMS.contains(from), "{from}");
    PENDULUMS.replace(from, to)
}

#[track_caller]
fn inspected(scene: &str) -> String {
    succeeds(with_scene(scene).path(), &["inspect", "scene.toml"])
}

#[test]
fn a_bath_has_its_temperature_and_what_spoils_it_is_named() {
    let text = inspected(PENDULUMS);
    assert!(text.contains("dp2 = ") && text.contains("∘ dW2 - γ p2 dt"), "{text}");
    assert!(text.contains("damping  γ = 0.7 on p1; γ = 0.3 on p2"), "{text}");
    assert!(text.contains("stationary with kT = 1.5\n"), "{text}");
    // The same by hand, spoilt in several ways; kT of the first is 1.5.
    let noise = |text: &str| without_bath(PENDULUMS).replace("kT = 1.5, ", text);
    let with = |noises: &str| {
        noise("kT = 1.5, ").replace("[damping]", &format!("H = {noises}\n[damping]"))
    };
    let right = "[\"sqrt(2*g*kT)*q1\", \"-sqrt(2*h*m*kT)*q2\"]";
    assert!(inspected(&with(right)).contains("kT = 1.5\n"));
    for (noises, words) in [
        (right.replace("*m", ""), "p2 has kT = 0.600000, its noise 0.632456 times"),
        (right.replace("2*h", "h"), "p2 has kT = 0.750000"),
        (right.replace("q1", "(q1 + q2)"), "p2 has kT = "),
        // One noise of both.
        (right.replace("\", \"-", " - "), "do not balance"),
        ("[\"sqrt(2*g*kT)*q1\"]".into(), "p2 is damped and not heated"),
        (right.replace("q1", "p1"), "q1 is heated and not damped"),
        (right.replace("*q1", "*q1^2"), "the temperature of p1 depends on the state"),
    ] {
        let text = inspected(&with(&noises));
        assert!(text.contains("No heat bath") && text.contains(words), "{noises}: {text}");
    }
    let text = inspected(&with(right).replace(", p2 = \"h\"", ""));
    assert!(text.contains("p2 is heated and not damped"), "{text}");
    // Nothing is damped or heated.
    let text = inspected(&noise("").replace("rates = { p1 = \"g\", p2 = \"h\" }", "rate = 0"));
    assert!(text.contains("every function of H0 is stationary"), "{text}");
}

/// State, B, H₀, friction, and noises where the temperature is not given.
type Bathed = (&'static str, &'static str, &'static str, &'static str, &'static [&'static str]);

/// A Hamiltonian with a mass matrix M, for which friction −γp asks for noise of covariance 2γkT M.
const COUPLED: &str = "p1^2/2 + p2^2/2 + 0.3*p1*p2 + q1^2 + q2^4";
const FIELD: &str = r#"[["0", "1", "0"], ["0", "1"], ["b"]]"#;

#[test]
fn temperatures_are_found_to_nine_digits() {
    let systems: [Bathed; 10] = [
        (r#"["q", "p"]"#, r#""canonical""#, "(q^2 + p^2)/2", "p = 0.4", &[]),
        (r#"["q", "p"]"#, r#""canonical""#, "p^2/3 + 1 - cos(q)", "p = 0.4", &[]),
        (r#"["q", "p"]"#, r#""canonical""#, "p^2/2 + (q^2 - 1)^2", "p = 2", &[]),
        (r#"["q", "p"]"#, r#""canonical""#, "p^2/2 + exp(-q) + q", "p = 1", &[]),
        (
            r#"["q[1..2]", "p[1..2]"]"#,
            r#""canonical""#,
            "(p1^2 + p2^2 + q1^2 + q2^2)/2 + q1^2*q2 - q2^3/3",
            "p = 0.7",
            &[],
        ),
        (
            r#"["q[1..3]", "p[1..3]"]"#,
            r#""canonical""#,
            "p1^2/2 + p2^2/4 + p3^2/6 + (q1 - q2)^2/2 + (q2 - q3)^4 + q1^2",
            "p1 = 1, p2 = 0.3, p3 = 2",
            &[],
        ),
        (
            r#"["x", "y", "u", "v"]"#,
            FIELD,
            "(u^2 + v^2)/2 + x^2 + y^2 + x*y",
            "u = 1, v = 0.2",
            &["sqrt(2*kT)*x", "sqrt(0.4*kT)*y"],
        ),
        // Both components have friction and noise.
        (
            r#"["q", "p"]"#,
            r#""canonical""#,
            "(q^2 + p^2)/2",
            "q = 0.5, p = 0.5",
            &["sqrt(kT)*p", "-sqrt(kT)*q"],
        ),
        (
            r#"["q[1..2]", "p[1..2]"]"#,
            r#""canonical""#,
            COUPLED,
            "p = 0.5",
            &["sqrt(kT/0.91)*(q1 - 0.3*q2)", "sqrt(kT)*q2"],
        ),
        // One rotated by 45°.
        (
            r#"["q[1..2]", "p[1..2]"]"#,
            r#""canonical""#,
            "(p1^2 + p2^2)/2 + q1^4 + q2^2",
            "p = 0.5",
            &["sqrt(kT/2)*(q1 + q2)", "sqrt(kT/2)*(q1 - q2)"],
        ),
    ];
    let found = |(state, b, energy, rates, noises): Bathed| {
        let bath = match noises {
            [] => format!("[bath]\nfriction = {{ {rates} }}\ntemperature = \"kT\""),
            _ => format!("[damping]\nrates = {{ {rates} }}"),
        };
        let initial = vec![
            0.3;
            if state.contains("..3") {
                6
            } else if state.len() > 12 {
                4
            } else {
                2
            }
        ];
        let scene = format!(
            "[system]\nstate = {state}\nB = {b}\nH0 = \"{energy}\"\nH = {noises:?}\n\
             parameters = {{ kT = 1.7, b = 0.8 }}\n{bath}\n[run]\n\
             initial = {initial:?}\nuntil = 1\nsteps = 64\n"
        );
        let folder = with_scene(&scene.replace("H = []\n", ""));
        json(folder.path(), &["inspect", "scene.toml", "--json"])["bath"].clone()
    };
    for system in systems {
        let bath = found(system);
        let beta = bath["beta"].as_f64().unwrap_or_else(|| panic!("{system:?}: {bath}"));
        assert!((beta * 1.7 - 1.0).abs() < 1e-9, "{system:?}: {beta}");
    }
    // Diagonal noise for a mass matrix that is not, and one direction twice as warm.
    let [.., coupled, rotated] = systems;
    let diagonal: &[&str] = &["sqrt(kT)*q1", "sqrt(kT)*q2"];
    let warm: &[&str] = &["sqrt(kT)*(q1 + q2)", "sqrt(kT/2)*(q1 - q2)"];
    for (system, noises) in [(coupled, diagonal), (rotated, warm)] {
        let bath = found((system.0, system.1, system.2, system.3, noises));
        assert!(
            bath["beta"].is_null() && !bath["mismatch"].as_array().unwrap().is_empty(),
            "{bath}"
        );
    }
}

#[test]
fn friction_on_all_components_is_damping() {
    let damping = |table: &str| {
        let scene = without_bath(PENDULUMS);
        let scene = scene.replace("rates = { p1 = \"g\", p2 = \"h\" }", table);
        let folder = with_scene(&scene);
        succeeds(folder.path(), &["run", "scene.toml", "--write", "npz", "--out", "run"]);
        ["paths.npz", "study.npz"]
            .map(|file| fs::read(folder.path().join("run").join(file)).unwrap())
    };
    let all = damping("rate = \"g\"");
    assert_eq!(damping("rate = \"g\"\ncomponents = [\"q\", \"p1\", \"p2\"]"), all);
    assert_eq!(damping("rates = { q = \"g\", p = \"g\" }"), all);
    assert_ne!(damping("rates = { p = \"g\" }"), all);
}

/// Half of C = ½(y2² + y3²) is damped.
const LASER: &str = r#"
[system]
name = "maxwell-bloch"
[damping]
rate = 0.5
components = ["y2", "y3"]
[run]
initial = [1, 2, 3]
until = 2
steps = 64
scheme = "sexp"
"#;

#[test]
fn laws_that_friction_keeps_are_drawn_with_their_decay() {
    let columns = |scene: &str| {
        let folder = with_scene(scene);
        succeeds(folder.path(), &["run", "scene.toml", "--write", "csv", "--out", "run"]);
        let csv = fs::read_to_string(folder.path().join("run/paths.csv")).unwrap();
        let mut lines = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let (header, last) = (lines.next().unwrap(), lines.next_back().unwrap());
        let last = header.iter().zip(last).map(|(name, x)| ((*name).to_owned(), x.parse().ok()));
        last.collect::<std::collections::BTreeMap<String, Option<f64>>>()
    };
    let kept = columns(LASER);
    assert!(kept["C defect"].unwrap().abs() < 1e-13, "{kept:?}");
    assert!((kept["C"].unwrap() / 6.5 - (-2f64).exp()).abs() < 1e-12, "{kept:?}");
    // Expectations have it, too, with a scheme of their own.
    let expect = "[expect]\nof = [\"(y2^2 + y3^2)/2\"]\naccuracy = 0.01\n";
    let folder = with_scene(&(LASER.replace("scheme = \"sexp\"", "") + expect));
    let found = json(folder.path(), &["expect", "scene.toml", "--json"]);
    let value = found["estimates"][0]["value"].as_f64().unwrap();
    assert!((value / 6.5 - (-2f64).exp()).abs() < 1e-12, "{value}");
    let broken = columns(&LASER.replace("[\"y2\", \"y3\"]", "[\"y2\"]"));
    assert!(!broken.contains_key("C"), "{broken:?}");
    // All monomials decay alike, if not by the same rates: y1 y2 with 0.5 + 0.1.
    let spins = r#"
[system]
state = ["a", "b", "c"]
B = [["0", "0"], ["1"]]
H0 = "b^2/2 + c^2/2"
[damping]
rates = { a = 0.5, b = 0.25 }
[run]
initial = [1, 2, 3]
until = 2
steps = 64
"#;
    let kept = columns(spins);
    assert!((kept["C1"].unwrap() / kept["a"].unwrap()).abs() > 0.0, "{kept:?}");
    assert!(kept["C1 defect"].unwrap().abs() < 1e-13 && !kept.contains_key("H0"), "{kept:?}");
}

/// One pendulum with flows of its parts, whose momentum alone is damped.
const PENDULUM: &str = r#"
[system]
name = "pendulum"
parameters = { c = 0.5 }
[damping]
rate = 1
components = ["y1"]
[run]
initial = [0.2, 1]
until = 1
steps = 64
[expect]
of = ["y1"]
accuracy = 0.1
"#;

#[test]
fn orders_are_those_without_friction() {
    // Without noise both halves of friction make the second order.
    let silent = &PENDULUM.replace("c = 0.5", "c = 0");
    for (scheme, scene, strong) in [
        ("sexp", PENDULUMS, 1.0),
        ("sexp-li", PENDULUMS, 1.0),
        ("heun", PENDULUMS, 1.0),
        ("midpoint", PENDULUM, 1.0),
        ("sexp", PENDULUM, 1.0),
        ("nv", PENDULUM, 1.0),
        ("sexp", silent, 2.0),
        ("heun", silent, 2.0),
        ("split", silent, 2.0),
    ] {
        let arguments =
            ["order", "scene.toml", "--json", "--scheme", scheme, "--path-steps", "4e6"];
        let found = json(with_scene(scene).path(), &arguments);
        assert_eq!(found["strong"]["order"], strong, "{scheme}: {}", found["strong"]["words"]);
    }
}

#[test]
fn what_cannot_be_is_refused_at_its_place() {
    for (from, to, words) in [
        ("p1 = \"g\"", "r1 = \"g\"", ["line 8, column 14", "`r1` is no component; the nearest is"]),
        ("p1 = \"g\"", "p = \"g\"", ["line 8, column 23", "`p2` is damped twice"]),
        ("p1 = \"g\"", "p1 = \"q\"", ["line 8, column 20", "unknown name `q`"]),
        (
            "[bath]",
            "[damping]\nrate = 1\nrates = { p1 = 1 }\n[bath]",
            ["line 8, column 8", "or `rates` such as"],
        ),
        ("friction = { p1 = \"g\", p2 = \"h\" }", "", ["line 9, column 15", "a bath acts by"]),
        ("p1^2/2", "p1^4", ["line 9, column 15", "no term p1^2/(2*m)"]),
        ("[bath]", "H = [\"q1\"]\n[bath]", ["line 7, column 5", "leave out `H`"]),
    ] {
        fails(with_scene(&changed(from, to)).path(), &["run", "scene.toml"], 2, &words);
    }
    let laser = LASER.to_owned() + "[bath]\ntemperature = 1\nfriction = { y2 = 1 }\n";
    fails(with_scene(&laser).path(), &["run", "scene.toml"], 2, &["a bath is for formulas"]);
}

/// Twice a half-width of 95 % is missed once in 10⁴ (normal), here by one of two in 2·10⁻⁴.
#[test]
fn momenta_have_the_temperature_of_the_bath() {
    let deviations = |scene: &str| {
        let scene = scene.replace("of = [\"p2\"]", "of = [\"p1^2\", \"p2^2/m\"]");
        let scene =
            scene.replace("until = 4", "until = 20").replace("accuracy = 0.1", "accuracy = 0.08");
        let found = json(with_scene(&scene).path(), &["expect", "scene.toml", "--json"]);
        let of = |k: usize| {
            let estimate = &found["estimates"][k];
            let [value, half] = ["value", "half_width"].map(|key| estimate[key].as_f64().unwrap());
            (value - 1.5).abs() / half
        };
        [of(0), of(1)]
    };
    let right = deviations(PENDULUMS);
    assert!(right.iter().all(|off| *off <= 2.0), "{right:?}");
    // A noise without the mass.
    let noises = "H = [\"sqrt(2*g*kT)*q1\", \"sqrt(2*h*kT)*q2\"]\n[damping]";
    let wrong = without_bath(PENDULUMS).replace("[damping]", noises);
    assert!(deviations(&wrong)[1] > 2.0, "{:?}", deviations(&wrong));
}

/// An energy that friction breaks is not said to be kept, and no theorem of the paper to apply.
#[test]
fn nothing_is_claimed_that_friction_breaks() {
    let scene = without_bath(PENDULUMS);
    let folder = with_scene(&scene);
    let text = succeeds(folder.path(), &["inspect", "scene.toml"]);
    let applies = text.lines().find(|line| line.contains("they apply:")).unwrap_or_default();
    assert!(!applies.contains("conformal") && !applies.contains("energy"), "{text}");
    assert!(text.contains("no bound was found"), "{text}");
    let text = succeeds(folder.path(), &["run", "scene.toml"]);
    assert!(
        text.contains("sexp: it damps exactly") && !text.contains("keeps the energy\n"),
        "{text}"
    );
}

/// Transverse damping of spins is a bath for noise of each with σ² = 2α kT/|s|.
#[test]
fn spins_with_transverse_damping_have_their_temperature() {
    let scene = |noise: &str, spin: &str, end: &str| {
        format!(
            "[system]\nname = \"spin-lattice\"\n[system.parameters]\nsizes = [3]\nexchange = 0.7\n\
             anisotropy = 0.2\nfield = [0, 0.3, 0.4]\n{noise}\n[run]\n\
             initial = [{spin}]\nuntil = 1\nsteps = 64\n{end}"
        )
    };
    let spins = |noise: &str, spin: &str, end: &str| {
        let folder = with_scene(&scene(noise, spin, end));
        json(folder.path(), &["inspect", "scene.toml", "--json"])["bath"].clone()
    };
    let (unit, long) = ("0, 0.6, 0.8", "0, 1.2, 1.6");
    let damped = "[damping]\nrate = 0.1";
    let bath = "[bath]\ntransverse = { s = 0.3 }\ntemperature = 0.7";
    let alone = "noise = 0.3\ntransverse = 0.3";
    for (noise, spin, kt) in
        [(bath, unit, 0.7), (bath, long, 0.7), (alone, unit, 0.15), (alone, long, 0.3)]
    {
        let bath = spins(noise, spin, "");
        let beta = bath["beta"].as_f64().unwrap_or_else(|| panic!("{noise}, {spin}: {bath}"));
        assert!((beta * kt - 1.0).abs() < 1e-9, "{noise}, {spin}: {beta}");
    }
    let mixed = "0, 0.6, 0.8, 0, 0, 1, 0, 1.2, 1.6";
    let words = ["line 10", "lengths from 1 to 2", "give `noise`"];
    let folder = with_scene(&scene(bath, mixed, ""));
    fails(folder.path(), &["run", "scene.toml"], 2, &words);
    for (noise, spin, end) in [
        ("noise = 0.3\ntransverse = 0.3\nlocal = false", unit, ""),
        (alone, mixed, ""),
        (alone, unit, damped),
        ("noise = 0\ntransverse = 0.3", unit, ""),
    ] {
        let bath = spins(noise, spin, end);
        let words = bath["mismatch"][0].as_str().unwrap_or_default();
        assert!(bath["beta"].is_null() && words.contains("σ² = 2α kT/|s|"), "{noise}: {bath}");
    }
}
