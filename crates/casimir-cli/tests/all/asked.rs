//! Questions with known answers that were answered wrongly once.

use crate::common::{fails, json, run, succeeds, with_scene};

const WELL: &str = r#"
[system]
state = ["q", "p"]
B = "canonical"
H0 = "p^2/2 + 0.0005*q^2"
[bath]
temperature = 1
friction = { p = 1 }
[run]
initial = [0, 1]
until = 10
steps = 100
"#;

/// e^(−H0/kT) has an integral however weak a spring is or hot a bath, and none of an angle, of
/// what falls at last, or of what does not grow; a logarithm is not known.
#[test]
fn integrals_are_judged_far_away() {
    let inspect = |energy: &str, temperature: &str| {
        let text = WELL.replace("0.0005*q^2", energy);
        let text = text.replace("temperature = 1", &format!("temperature = {temperature}"));
        succeeds(with_scene(&text).path(), &["inspect", "scene.toml"])
    };
    for (energy, temperature) in [
        ("0.0005*q^2", "1"),
        ("q^2/2", "1000"),
        ("0.05*abs(q)", "1"),
        ("1e-9*q^2", "1"),
        ("q^4/3", "1"),
    ] {
        let said = inspect(energy, temperature);
        assert!(!said.contains("no integral") && !said.contains("is not known"), "{said}");
    }
    for energy in ["cos(q)", "q^2 - 1e-5*q^3", "tanh(q)^2"] {
        let said = inspect(energy, "1");
        assert!(said.contains("no integral"), "{said}");
    }
    let said = inspect("0.4*ln(1 + q^2)", "1");
    assert!(!said.contains("has no integral"), "{said}");
}

/// Without noise one path is enough, also where a noise is there and zero.
#[test]
fn noises_of_zero_are_none() {
    let kubo = succeeds(with_scene("").path(), &["new", "kubo"]);
    let folder = with_scene(&kubo);
    let found = json(folder.path(), &["expect", "scene.toml", "--json", "--set", "sigma=0"]);
    assert!(found["reached"] == true, "{found}");
    let lattice = r#"
[system]
name = "spin-lattice"
[system.parameters]
sizes = [3]
exchange = 0
field = [0, 0, 1.2]
transverse = 0.3
[run]
initial = ["sqrt(0.96)", 0, 0.2]
until = 2
steps = 400
"#;
    let folder = with_scene(lattice);
    let of = ["expect", "scene.toml", "--of", "mz", "--accuracy", "1e-4", "--json"];
    let found = json(folder.path(), &of);
    let value = found["estimates"][0]["value"].as_f64().unwrap();
    assert!((value - (0.2f64.atanh() + 0.72).tanh()).abs() < 1e-4, "{found}");
}

/// dv = 0.1(0.2 − v) dt + ½√max(v, 0) dW in Itô's sense: E v is that without noise, also on paths
/// that pass zero.
#[test]
fn roots_of_what_is_cut_at_zero_go_on() {
    let scene = r#"
[system]
state = ["v"]
calculus = "ito"
drift = ["0.1*(0.2 - v)"]
noise = [["0.5*sqrt(max(v, 0))"]]
[run]
initial = [0.04]
until = 1
steps = 1000
paths = 4000
scheme = "em"
"#;
    let said = json(with_scene(scene).path(), &["run", "scene.toml", "--json"]);
    let last = &said["at_end"]["v"];
    assert!(last["count"] == 4000 && said["warnings"] == serde_json::json!([]), "{said}");
    let [lo, hi] = [0, 1].map(|end| last["mean_interval"][end].as_f64().unwrap());
    let exact = 0.2 - 0.16 * (-0.1f64).exp();
    let slack = hi - lo;
    assert!(lo - slack < exact && exact < hi + slack, "{lo} {exact} {hi}");
}

/// A law without variance asks for more chains than can be counted.
#[test]
fn more_chains_than_can_be_counted_are_no_panic() {
    let scene = r#"
[system]
state = ["x"]
calculus = "ito"
drift = ["-x"]
noise = [["sqrt(2.5)*x"], ["1"]]
[run]
initial = [0]
until = 20
steps = 800
"#;
    for seed in ["3", "6", "7"] {
        let words = ["equilibrium", "scene.toml", "--of", "x^2", "--accuracy", "0.2"];
        let more = ["--seed", seed, "--threads", "1", "--path-steps", "2e7"];
        let output = run(with_scene(scene).path(), &[&words[..], &more].concat());
        assert!(output.status.code() != Some(101), "{output:?}");
    }
    let of = ["equilibrium", "scene.toml", "--of", "nothing", "--accuracy", "1"];
    fails(with_scene(scene).path(), &of, 2, &["nothing"]);
}

/// Times and states at which paths without noise stop, in closed form: free fall, decay, and a
/// pendulum that passes at nearly the same place of a step at all step sizes.
#[test]
fn paths_without_noise_stop_where_they_must() {
    let fall = "B = \"canonical\"\nH0 = \"p^2/2 + 9.81*q\"";
    let pendulum = "B = \"canonical\"\nH0 = \"p^2/2 - cos(q)\"";
    let decay = |k: f64| format!("drift = [\"-{k}*x\"]");
    // The pendulum's integral by a Runge–Kutta method of order four with steps of 10⁻⁵.
    for (state, system, initial, until, condition, time, at, integral) in [
        ("q p", fall.to_owned(), "[2, 0]", 1, "q < 0", 0.638_550_859, 0.0, 0.851_401_145),
        ("q p", pendulum.to_owned(), "[1, 0]", 4, "q < -0.3", 1.993_19, -0.3, 1.026_057_991),
        ("x", decay(2.1), "[1]", 2, "x < 0.4", 2.5f64.ln() / 2.1, 0.4, 0.6 / 2.1),
        ("x", decay(3.3), "[1]", 2, "x < 0.4", 2.5f64.ln() / 3.3, 0.4, 0.6 / 3.3),
        ("x", decay(1.0), "[1]", 2, "x < 0.4", 2.5f64.ln(), 0.4, 0.6),
    ] {
        // A path stays where it stops.
        let way = integral + at * (f64::from(until) - time);
        let components: Vec<&str> = state.split(' ').collect();
        let scene = format!(
            "[system]\nstate = {components:?}\n{system}\n[run]\ninitial = {initial}\nuntil = \
             {until}\nsteps = 200\npaths = 100\n[events]\nc = {{ when = \"{condition}\", stop = \
             true }}\n[observe]\nway = \"integral({0})\"\n[expect]\nof = [\"c time\", \"{0}\", \
             \"way\"]\naccuracy = 0.01",
            components[0]
        );
        let folder = with_scene(&scene);
        let found = json(folder.path(), &["expect", "scene.toml", "--json"]);
        assert!(found["reached"] == true, "{found}");
        for (k, exact, rounding) in [(0, time, 1e-5), (1, at, 1e-12), (2, way, 1e-6)] {
            let of = |key: &str| found["estimates"][k][key].as_f64().unwrap();
            let (value, half) = (of("value"), of("half_width"));
            assert!((value - exact).abs() < half + rounding, "{condition}: {value} {half} {exact}");
            assert!(half <= 0.01, "{found}");
        }
        let run = json(folder.path(), &["run", "scene.toml", "--json"]);
        let end = |name: &str| run["at_end"][name]["mean"].as_f64().unwrap();
        assert!((end(components[0]) - at).abs() < 1e-12, "{run}");
        // By trapezoids of 200 steps and a part of one.
        assert!((end("way") - way).abs() < 1e-4, "{run}");
    }
}

/// What no noise moves is known; a payoff that no path reaches is not.
#[test]
fn what_does_not_vary_beside_noise_is_believed() {
    let scene = r#"
[system]
state = ["q1", "q2", "p1", "p2"]
B = "canonical(q1, p1) + canonical(q2, p2)"
H0 = "(p1^2 + p2^2 + w^2*(q1^2 + q2^2))/2"
H = ["s*q1"]
parameters = { w = 1.3, s = 0.5, b = 1 }
[run]
initial = [1, 1, 0, 0]
until = 2
steps = 64
[expect]
of = ["q2", "b*q1"]
accuracy = 0.01
gradient = ["s", "b"]
"#;
    let found = json(with_scene(scene).path(), &["expect", "scene.toml", "--json"]);
    assert!(found["reached"] == true && found["warnings"] == serde_json::json!([]), "{found}");
    let value = found["estimates"][0]["value"].as_f64().unwrap();
    assert!((value - 2.6f64.cos()).abs() < 1e-14, "{found}");
    for parameter in ["s", "b"] {
        assert!(found["gradient"][parameter][0]["value"] == 0.0, "{found}");
    }
    let rare = scene.replace("\"b*q1\"", "\"max(q1 - 10, 0)\"").replace("gradient", "#");
    let folder = with_scene(&rare);
    fails(folder.path(), &["expect", "scene.toml"], 1, &["not to be believed"]);
}

/// The change of a parameter does not follow rounding errors of an observable that is zero.
#[test]
fn an_observable_that_is_zero_leaves_other_derivatives_alone() {
    let scene = r#"
[system]
state = ["a[xyz]", "b[xyz]"]
B = "spins"
H0 = "-1.5*dot(a, b)"
H = ["s*(ax + bx)", "s*(ay + by)", "s*(az + bz)"]
parameters = { s = 0.4 }
[run]
initial = [0, 0, 1, 0.6, 0.8, 0]
until = 2
steps = 64
[expect]
of = ["az + bz", "dot(a, b)", "1e-18*az", "norm(a) - 1"]
accuracy = 0.02
gradient = ["s"]
"#;
    let found = json(with_scene(scene).path(), &["expect", "scene.toml", "--json"]);
    let of = |k: usize, key: &str| found["gradient"]["s"][k][key].as_f64().unwrap();
    let exact = -1.6 * (-0.32f64).exp();
    assert!((of(0, "value") - exact).abs() < 1.6 * of(0, "half_width"), "{found}");
    assert!(of(0, "half_width") < 0.02, "{found}");
}

/// What is kept to rounding is known to rounding, not better: H0 without noise, and the length of a
/// spin beside it.
#[test]
fn rounding_errors_of_many_steps_are_in_the_bound() {
    let scene = r#"
[system]
state = ["s[xyz]"]
B = "spins"
H0 = "sx^2 + 2*sy^2 + 3*sz^2"
[run]
initial = [0.48, 0.6, 0.64]
until = 50
steps = 3200
scheme = "sexp"
[expect]
of = ["sx^2 + 2*sy^2 + 3*sz^2", "norm(s)", "norm(s)^4"]
accuracy = 0.01
"#;
    let found = json(with_scene(scene).path(), &["expect", "scene.toml", "--json"]);
    for (k, exact) in [(0, 2.1792), (1, 1.0), (2, 1.0)] {
        let of = |key: &str| found["estimates"][k][key].as_f64().unwrap();
        let (value, half) = (of("value"), of("half_width"));
        assert!((value - exact).abs() <= half && half < 1e-11, "{value} {half} {exact}");
    }
}

/// A list of one is its item.
#[test]
fn an_item_stands_for_a_list() {
    let scene = r#"
[system]
state = ["q", "p"]
B = "canonical"
H0 = "p^2/2 + q^2/2"
H = ["s*q"]
parameters = { s = 0.4 }
[damping]
rate = 0.1
components = ["p"]
[run]
initial = [1, 0]
until = 1
steps = 32
[expect]
of = ["q^2"]
accuracy = 0.05
gradient = ["s"]
"#;
    let found = |scene: &str| {
        let folder = with_scene(scene);
        let found = json(folder.path(), &["expect", "scene.toml", "--json"]);
        [found["estimates"].clone(), found["gradient"].clone()]
    };
    let items = scene.replace("[\"s*q\"]", "\"s*q\"").replace("[\"q^2\"]", "\"q^2\"");
    let items = items.replace("[\"s\"]", "\"s\"").replace("[\"p\"]", "\"p\"");
    assert_eq!(found(scene), found(&items));
    let plain = "[system]\nstate = [\"x\"]\ndrift = [\"-x\"]\nnoise = [[\"0.3\"]]\n[run]\n\
                 initial = [1]\nuntil = 1\nsteps = 32\n[expect]\nof = \"x\"\naccuracy = 0.05\n";
    let single = plain.replace("[\"x\"]", "\"x\"").replace("[\"-x\"]", "\"-x\"");
    assert_eq!(found(plain), found(&single));
    let wrong = items.replace("of = \"q^2\"", "of = \"r^2\"");
    let words = ["line 16, column 7", "unknown name `r`"];
    fails(with_scene(&wrong).path(), &["expect", "scene.toml"], 2, &words);
}

/// What `[expect]` lacks is given by options, and several parameters by commas.
#[test]
fn options_complete_a_table() {
    const OSCILLATOR: &str = "[system]\nstate = [\"q\", \"p\"]\nB = \"canonical\"\n\
                              H0 = \"(p^2 + w^2*q^2)/2\"\nH = [\"-s*q\"]\n\
                              parameters = { w = 2, s = 0.1 }\n[run]\ninitial = [1, 0]\n\
                              until = 1\nsteps = 16\n[expect]\n";
    let with = |table: &str| with_scene(&format!("{OSCILLATOR}{table}\n"));
    let expect = |table: &str, options: &[&str]| {
        let words = [&["expect", "scene.toml", "--json"], options].concat();
        let found = json(with(table).path(), &words);
        found["estimates"][0]["value"].as_f64().unwrap()
    };
    let exact = 2f64.cos();
    for (table, options) in [
        ("of = [\"q\"]", &["--accuracy", "1e-3"][..]),
        ("accuracy = 1e-3", &["--of", "q"]),
        ("", &["--of", "q", "--accuracy", "1e-3"]),
    ] {
        assert!((expect(table, options) - exact).abs() < 2e-3, "{table} {options:?}");
    }
    let words = ["expect", "scene.toml", "--json", "--gradient", "w,s"];
    let found = json(with("of = [\"q\"]\naccuracy = 1e-3").path(), &words);
    let slope = |of: &str| found["gradient"][of][0]["value"].as_f64().unwrap();
    // E[q] = cos wT has no s.
    assert!((slope("w") + 2f64.sin()).abs() < 2e-3 && slope("s").abs() < 2e-3, "{found}");
    let lacks = |table: &str, words: &[&str]| {
        fails(with(table).path(), &["expect", "scene.toml"], 2, words);
    };
    lacks("of = [\"q\"]", &["no accuracy is wanted: give --accuracy"]);
    lacks("accuracy = 1e-3", &["nothing is expected: give --of q"]);
    lacks("of = [\"q\"]\naccuracy = -1", &["line 13, column 12", "must be positive"]);
}

/// The flow of a rotation has its phase at any step; noise and friction enter it once in a step, of
/// which there were eight for 32 turns, and for 64 of a spin.
#[test]
fn exact_flows_resolve_fast_motion() {
    let oscillator = "state = [\"q\", \"p\"]\nB = \"canonical\"\nH0 = \"32*pi*(p^2 + q^2)\"\n\
                      H = [\"0.1*q\"]\n[damping]\nrates = { p = 1 }\n";
    let spin = "state = [\"q\", \"y\", \"z\"]\nB = \"spins\"\nH0 = \"-128*pi*z\"\nH = [\"q\"]\n";
    for (system, initial, of, exact) in [
        // Averages over a turn: half of the friction and of the noise act.
        (oscillator, "1, 0", "q^2 + p^2", (-1f64).exp() + 0.01 * (1.0 - (-1f64).exp())),
        (spin, "1, 0, 0", "q", (-0.25f64).exp()),
    ] {
        let text = format!(
            "[system]\n{system}[run]\ninitial = [{initial}]\nuntil = 1\nsteps = 100\n\
             [expect]\nof = [\"{of}\"]\naccuracy = 0.02\n"
        );
        let found = json(with_scene(&text).path(), &["expect", "scene.toml", "--json"]);
        let one = &found["estimates"][0];
        let far = (one["value"].as_f64().unwrap() - exact).abs();
        assert!(found["scheme"] == "nv" && found["reached"] == true, "{found:#}");
        assert!(far < 2.5 * one["half_width"].as_f64().unwrap(), "{far} {found:#}");
        // The twin: eight steps, as there were.
        assert!(found["levels"].as_array().unwrap().len() > 8, "{found:#}");
    }
    // What no level follows is refused after the pilot.
    let text = format!(
        "[system]\n{}[run]\ninitial = [1, 0, 0]\nuntil = 1\nsteps = 100\n\
         [expect]\nof = [\"q\"]\naccuracy = 0.02\n",
        spin.replace("128", "2e6")
    );
    let refused = run(with_scene(&text).path(), &["expect", "scene.toml", "--json"]);
    let found: serde_json::Value = serde_json::from_slice(&refused.stdout).unwrap();
    let words = |one: &serde_json::Value| one["what"].as_str().unwrap().to_owned();
    let said: Vec<String> = found["warnings"].as_array().unwrap().iter().map(words).collect();
    assert!(said.iter().any(|what| what.contains("do not resolve the fastest motion")), "{said:?}");
    assert!(said.iter().any(|what| what.contains("out of reach")), "{said:?}");
    assert_eq!(found["levels"].as_array().unwrap().len(), 4, "{found:#}");
}

/// Samples of a constant with rounding errors are no rare events.
#[test]
fn rounding_errors_are_no_rare_events() {
    let text = "[system]\nname = \"sphere-euler\"\nparameters = { size = 6, advection = 0, \
                degrees = 1, strengths = 0.5 }\n[run]\ninitial = [0, 0, 1]\nuntil = 0.5\n\
                steps = 20\n[expect]\nof = [\"energy\"]\naccuracy = 0.01\n";
    let found = json(with_scene(text).path(), &["expect", "scene.toml", "--json"]);
    assert!(found["reached"] == true && found["warnings"] == serde_json::json!([]), "{found:#}");
    assert!((found["estimates"][0]["value"].as_f64().unwrap() - 0.25).abs() < 1e-10);
}

/// An expectation that failed keeps no samples, which would refuse the scene once it is mended.
#[test]
fn what_failed_is_not_gone_on_with() {
    let text = "[system]\nstate = [\"x\"]\ndrift = [\"x^2\"]\nnoise = [[\"0.1\"]]\n\
                [run]\ninitial = [1]\nuntil = 2\nsteps = 20\n[expect]\nof = [\"x\"]\n\
                accuracy = 0.05\n";
    let folder = with_scene(text);
    fails(folder.path(), &["expect", "scene.toml"], 1, &["failed"]);
    std::fs::write(folder.path().join("scene.toml"), text.replace("x^2", "x - x^2")).unwrap();
    let found = json(folder.path(), &["expect", "scene.toml", "--json"]);
    assert!((found["estimates"][0]["value"].as_f64().unwrap() - 1.0).abs() < 0.06, "{found:#}");
}
