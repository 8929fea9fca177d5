//! Parameters that are fitted to simulated data: do the intervals cover, is χ² one?

use casimir::{
    mc::Simulation,
    noise::{StreamKey, WienerPath},
};
use scenes::Scene;
use serde_json::{Value, json};
use verbs::Watch;

use super::super::fit::{KUBO, scene};

/// Samples of Kubo's oscillator by its exact law, q − ip = e^{i(wt + sW(t))}, at four times.
fn samples_of_kubo(seed: u64, w: f64, s: f64) -> String {
    let mut text = String::from("t,q,p\n");
    let key = StreamKey { seed: 1000 + seed, experiment: 7 };
    for k in 1..=4u32 {
        let t = 0.5 * f64::from(k);
        let mut normals = WienerPath::<1>::new(key, u64::from(k));
        for _ in 0..250 {
            let angle = w * t + s * normals.increments(t.sqrt())[0];
            text += &format!("{t},{:?},{:?}\n", angle.cos(), -angle.sin());
        }
    }
    text
}

fn fitted(scene: &Scene, table: String, parameters: &[&str]) -> Value {
    let options = json!({ "table": table, "parameters": parameters }).to_string();
    let found = verbs::call("fit", &options, scene, &Watch::new(())).expect("a fit");
    found.json
}

/// Number of data sets for which each interval has the truth, and that of probabilities below 5 %.
fn coverage(
    scene: &Scene,
    truth: &[(&str, f64)],
    sets: u64,
    data: &dyn Fn(u64) -> String,
) -> (Vec<u64>, u64) {
    let (mut covered, mut small) = (vec![0; truth.len()], 0);
    let names: Vec<&str> = truth.iter().map(|(name, _)| *name).collect();
    for set in 0..sets {
        let found = fitted(scene, data(set), &names);
        for (k, (_, exact)) in truth.iter().enumerate() {
            let [lo, hi] = ["lo", "hi"].map(|key| found["parameters"][k][key].as_f64().unwrap());
            covered[k] += u64::from(lo < *exact && *exact < hi);
        }
        small += u64::from(found["probability"].as_f64().unwrap() < 0.05);
    }
    (covered, small)
}

#[test]
#[ignore = "a minute or two"]
fn intervals_of_an_oscillator_cover_long() {
    let found = coverage(&scene(KUBO), &[("w", 1.0), ("s", 0.5)], 200, &|set| {
        samples_of_kubo(set, 1.0, 0.5)
    });
    println!("{found:?}");
}

/// Paths of a rigid body by Heun's scheme in many steps.
fn samples_of_body(seed: u64) -> String {
    let scene =
        scene(&BODY.replace("steps = 64", &format!("steps = 1024\nseed = {}", 5000 + seed)));
    let setup = scene.setup("heun").unwrap();
    let simulation = Simulation::new(setup, scene.settings.truncation).every(256);
    let tables = simulation.paths(1024, scene.settings.key, 0..1000).unwrap();
    let mut text = String::from("t,x,y,z\n");
    for (n, table) in tables.iter().enumerate() {
        // One observation of each path.
        let k = 1 + n % 4;
        let [x, y, z] = ["y1", "y2", "y3"].map(|name| table.column(name).unwrap()[k]);
        text += &format!("{},{x:?},{y:?},{z:?}\n", table.times()[k]);
    }
    text
}

const BODY: &str = r#"
[system]
state = ["x", "y", "z"]
B = "rigid"
H0 = "x^2/(2*I1) + y^2/2 + 3*z^2/4"
H = ["s*x^2/2", "s*y^2/4", "s*z^2/6"]
parameters = { I1 = 2, s = 1 }
[damping]
rate = "cos(2*t)/2"
[run]
initial = ["cos(1.1)", 0, "sin(1.1)"]
until = 2
steps = 64
"#;

#[test]
#[ignore = "a minute or two"]
fn intervals_of_a_rigid_body_cover_long() {
    let start = BODY.replace("I1 = 2, s = 1", "I1 = 1.7, s = 0.8");
    let found = coverage(&scene(&start), &[("I1", 2.0), ("s", 1.0)], 200, &samples_of_body);
    println!("{found:?}");
}
