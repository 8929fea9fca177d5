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
