//! Heat baths by formulas: known averages by default settings, what `inspect` finds of them, and
//! heat between two temperatures.
//!
//! Averages have intervals of 95 %: one is missed by 2.5 half-widths in 1e-6 of all cases.

use serde_json::Value;

use crate::common::{fails, json, run, succeeds, with_scene};

const MISSES: f64 = 2.5;

fn scene(system: &str, bath: &str, initial: &str, of: &str, accuracy: f64) -> String {
    format!(
        "[system]\n{system}\n{bath}\n[run]\ninitial = {initial}\nuntil = 10\nsteps = 400\n\
         [expect]\nof = [{of}]\naccuracy = {accuracy}\n"
    )
}

fn averaged(scene: &str) -> Value {
    let found = json(with_scene(scene).path(), &["equilibrium", "scene.toml", "--json"]);
    assert!(found["reached"] == true, "{found:#}");
    found
}

/// How far average number k is from a value, in half-widths.
fn off(found: &Value, k: usize, exact: f64) -> f64 {
    let of = &found["estimates"][k];
    let [value, half] = ["value", "half_width"].map(|key| of[key].as_f64().unwrap());
    (value - exact).abs() / half
}

fn coth(x: f64) -> f64 {
    1.0 / x.tanh()
}

/// ⟨cos θ⟩ of a unit vector with the energy −xkT cos θ: Langevin's function.
fn langevin(x: f64) -> f64 {
    coth(x) - 1.0 / x
}

/// One spin in a field, of length 2.
const SPIN: &str = "state = [\"s[xyz]\"]\nB = \"spins(s)\"\nH0 = \"-0.7*sz\"";

#[test]
fn spins_by_formulas_have_their_averages() {
    let bath = "[bath]\ntemperature = 0.5\ntransverse = { s = 0.3 }";
    let spin = scene(SPIN, bath, "[2, 0, 0]", "\"sz\"", 0.01);
    let found = averaged(&spin);
    assert!(found["scheme"] == "metropolis");
    let exact = 2.0 * langevin(2.0 * 0.7 / 0.5);
    assert!(off(&found, 0, exact) < MISSES, "{found:#}");
    // The twin: a temperature that is a tenth too high.
    let warm = averaged(&spin.replace("= 0.5", "= 0.55"));
    assert!(off(&warm, 0, exact) > MISSES, "{warm:#}");
    // Fisher's open chain of four: ⟨s₁·s₂⟩ = u(J/kT), ⟨s₁·s₄⟩ = u³.
    let pairs =
        [(1, 2), (2, 3), (3, 4)].map(|(a, b)| format!("s{a}x*s{b}x + s{a}y*s{b}y + s{a}z*s{b}z"));
    let chain = format!(
        "state = [\"s[1..4][xyz]\"]\nB = \"spins(s1, s2, s3, s4)\"\nH0 = \"-({})\"",
        pairs.join(" + ")
    );
    let bath = "[bath]\ntemperature = 0.8\ntransverse = { s1 = 0.2, s2 = 0.2, s3 = 0.2, s4 = 0.2 }";
    let of = format!("\"{}\", \"s1x*s4x + s1y*s4y + s1z*s4z\"", pairs[0]);
    let initial = format!("[{}]", ["0, 0.6, 0.8"; 4].join(", "));
    let found = averaged(&scene(&chain, bath, &initial, &of, 0.01));
    let u = langevin(1.0 / 0.8);
    assert!(off(&found, 0, u) < MISSES && off(&found, 1, u.powi(3)) < MISSES, "{found:#}");
}

/// Two sublattices with moments in the ratio 4, without exchange, each with damping of its own.
#[test]
fn materials_have_one_temperature() {
    let spins = "state = [\"s[1..2][xyz]\"]\nB = \"spins(s1, s2)\"\nH0 = \"-0.5*s1z - 0.5*s2z\"";
    let bath = "[bath]\ntemperature = 0.6\ntransverse = { s1 = 0.2, s2 = 0.05 }";
    let found = averaged(&scene(spins, bath, "[1, 0, 0, 0, 4, 0]", "\"s1z\", \"s2z\"", 0.02));
    for (k, size) in [(0, 1.0), (1, 4.0)] {
        let exact = size * langevin(0.5 * size / 0.6);
        assert!(off(&found, k, exact) < MISSES, "{found:#}");
    }
    // A lattice has noise of one strength, which moments that differ are not in balance with.
    let lattice = "name = \"spin-lattice\"\nparameters = { sizes = [2], exchange = 0, \
                   field = [0, 0, 0.5], transverse = 0.2, noise = 0.3 }";
    let folder = with_scene(&scene(lattice, "", "[1, 0, 0, 0, 4, 0]", "\"mz\"", 0.1));
    let text = succeeds(folder.path(), &["inspect", "scene.toml"]);
    assert!(text.contains("No heat bath") && text.contains("of one length |s|"), "{text}");
}

/// A heavy top with spherical inertia on Γ·Π = 0: ⟨Γ₃⟩ = −(coth x − 1/x) with x = β·mgl, and
/// ⟨½|Π|²⟩ = kT, two degrees of freedom.
#[test]
fn a_heavy_top_has_its_averages() {
    let top = "state = [\"P[1..3]\", \"G[1..3]\"]\n\
               B = [[\"-P3\", \"P2\", \"0\", \"-G3\", \"G2\"], [\"-P1\", \"G3\", \"0\", \"-G1\"],\n\
               [\"-G2\", \"G1\", \"0\"], [\"0\", \"0\"], [\"0\"]]\n\
               H0 = \"(P1^2 + P2^2 + P3^2)/2 + 1.2*G3\"";
    let bath = "[bath]\ntemperature = 0.5\nthrough = [\"0.7*G1\", \"0.7*G2\", \"0.7*G3\"]";
    let of = "\"G3\", \"(P1^2 + P2^2 + P3^2)/2\"";
    let found = averaged(&scene(top, bath, "[0.3, 0, 0, 0, 0, 1]", of, 0.01));
    assert!(off(&found, 0, -langevin(1.2 / 0.5)) < MISSES, "{found:#}");
    assert!(off(&found, 1, 0.5) < MISSES, "{found:#}");
}

/// The rigid body with I = (2, 1, ⅔).
const BODY: &str = "state = [\"y[1..3]\"]\nB = \"rigid\"\nH0 = \"y1^2/4 + y2^2/2 + 0.75*y3^2\"";
const THROUGH: &str = "[bath]\ntemperature = 0.5\nthrough = [\"y1\", \"y2\", \"y3\"]";

/// The schemes that follow paths have the law, with the bias of the step in their intervals; and
/// the sum of Lyapunov exponents is −½β²Σ⟨{H₀, Φₘ}²⟩ = −0.19812 at β = 2.
#[test]
fn paths_of_a_body_have_the_law_and_contract_as_they_must() {
    let body = scene(BODY, THROUGH, "[0.6, 0, 0.8]", "\"y1^2/4 + y2^2/2 + 0.75*y3^2\"", 5e-3);
    let folder = with_scene(&body);
    for scheme in ["sexp", "sexp-li"] {
        let arguments = ["equilibrium", "scene.toml", "--json", "--scheme", scheme];
        let found = json(folder.path(), &arguments);
        assert!(off(&found, 0, 0.466_979_896_5) < MISSES, "{scheme}: {found:#}");
        std::fs::remove_dir_all(folder.path().join("scene-equilibrium")).unwrap();
    }
    let arguments = ["lyapunov", "scene.toml", "--count", "3", "--accuracy", "0.02", "--json"];
    let found = json(folder.path(), &arguments);
    let sum = found["estimates"].as_array().unwrap().len() - 1;
    assert!(off(&found, sum, -0.198_120_621_1) < MISSES, "{found:#}");
    // The twin, −H₀ in the same bath, has e^{+βH₀}: ⟨H₀⟩ = 0.534.
    let turned = BODY.replace("H0 = \"y1^2/4 + y2^2/2 + ", "H0 = \"-y1^2/4 - y2^2/2 - ");
    let energy = "\"y1^2/4 + y2^2/2 + 0.75*y3^2\"";
    let turned = averaged(&scene(&turned, THROUGH, "[0.6, 0, 0.8]", energy, 5e-3));
    let value = turned["estimates"][0]["value"].as_f64().unwrap();
    assert!((value - 0.534).abs() < 0.01, "{turned:#}");
}

/// Two oscillators with a spring between baths of 2 and 1: the covariance S solves AS + SAᵀ = −D,
/// and γ₁(T₁ − S(p₁p₁)) goes through.
#[test]
fn heat_between_two_temperatures_is_that_of_theory() {
    let chain = "state = [\"q[1..2]\", \"p[1..2]\"]\nB = \"canonical\"\n\
                 H0 = \"(p1^2 + p2^2 + q1^2 + q2^2)/2 + (q1 - q2)^2/4\"";
    let baths = "[[bath]]\ntemperature = 2\nfriction = { p1 = 0.6 }\n\
                 [[bath]]\ntemperature = 1\nthrough = [\"sqrt(1.8)*q2\"]";
    let scene =
        scene(chain, baths, "[1, 0, 0, 0]", "\"heat1\", \"heat2\", \"heat1 + heat2\"", 0.01);
    let found = averaged(&scene);
    assert!(found["scheme"] == "baoab", "{found:#}");
    let exact = current();
    assert!(off(&found, 0, exact) < MISSES && off(&found, 1, -exact) < MISSES, "{found:#}");
    assert!(off(&found, 2, 0.0) < MISSES && exact > 0.05, "{found:#}");
}

/// The current of the chain above, by the fixed point of S ↦ S + h(AS + SAᵀ + D).
fn current() -> f64 {
    let a = [
        [0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
        [-1.5, 0.5, -0.6, 0.0],
        [0.5, -1.5, 0.0, -0.9],
    ];
    let noise = [0.0, 0.0, 2.0 * 0.6 * 2.0, 2.0 * 0.9];
    let mut s = [[0.0; 4]; 4];
    for _ in 0..20_000 {
        let product: [[f64; 4]; 4] = std::array::from_fn(|i| {
            std::array::from_fn(|j| (0..4).map(|k| a[i][k] * s[k][j]).sum())
        });
        for i in 0..4 {
            for j in 0..4 {
                let d = if i == j { noise[i] } else { 0.0 };
                s[i][j] += 0.01 * (product[i][j] + product[j][i] + d);
            }
        }
    }
    0.6 * (2.0 - s[2][2])
}

fn inspected(system: &str, bath: &str, initial: &str) -> (Value, String) {
    let folder = with_scene(
        &scene(system, bath, initial, "\"1\"", 1.0)
            .replace("[expect]\nof = [\"1\"]\naccuracy = 1\n", ""),
    );
    let found = json(folder.path(), &["inspect", "scene.toml", "--json"])["bath"].clone();
    (found, succeeds(folder.path(), &["inspect", "scene.toml"]))
}

const PLANE: &str = "state = [\"q\", \"p\"]\nB = \"canonical\"\nH0 = \"p^2/2 + q^4/4\"";
const TOP: &str = "state = [\"x\", \"y\", \"z\"]\nB = \"rigid\"\nH0 = \"x^2/2 + y^2/2 + z^2\"";

/// Twelve baths at kT = 0.7 with what is said of them, and twelve that are none, with the reason.
#[test]
fn baths_are_found_and_spoilt_ones_are_named() {
    let unit = "[0.6, 0, 0.8]";
    let bath = |rest: &str| format!("[bath]\ntemperature = 0.7\n{rest}");
    let through = |functions: &str| bath(&format!("through = [{functions}]"));
    let spins =
        "state = [\"s[1..2][xyz]\"]\nB = \"spins(s1, s2)\"\nH0 = \"-s1x*s2x - 0.3*s1z - 0.2*s2z\"";
    let field = "state = [\"x\", \"y\", \"u\", \"v\"]\nB = [[\"0\", \"1\", \"0\"], [\"0\", \"1\"], [\"0.8\"]]\n\
                 H0 = \"(u^2 + v^2)/2 + x^2 + y^4\"";
    let all = "reach all";
    for (system, bath, initial, words) in [
        (PLANE, through("\"0.4*q\""), "[1, 0]", "all 2 directions"),
        (PLANE, through("\"0.4*q^2\""), "[1, 0]", all),
        (PLANE, through("\"0.4*p\""), "[1, 0]", all),
        (PLANE, through("\"sin(q) + q*p\""), "[1, 0]", all),
        (PLANE, bath("friction = { p = 0.3 }"), "[1, 0]", "it has an integral"),
        (BODY, through("\"y1\", \"y2\", \"y3\""), unit, "leaves are compact"),
        (BODY, through("\"y1 + y2*y3\""), unit, all),
        (TOP, through("\"x\""), unit, all),
        // Around its axis of symmetry H₀ does not turn.
        (TOP, through("\"z\", \"0.5*x\""), unit, all),
        (spins, bath("transverse = { s1 = 0.2, s2 = 0.1 }"), "[1, 0, 0, 0, 2, 0]", all),
        (spins, bath("transverse = { s1 = 0.2 }"), "[1, 0, 0, 0, 2, 0]", all),
        (field, through("\"0.5*x\", \"0.3*y\""), "[1, 0, 0, 0.5]", "all 4 directions"),
    ] {
        let (found, text) = inspected(system, &bath, initial);
        let beta = found["beta"].as_f64().unwrap_or_else(|| panic!("{system} {bath}: {text}"));
        assert!((beta * 0.7 - 1.0).abs() < 1e-8, "{system} {bath}: {beta}");
        assert!(text.contains(words), "{system} {bath}: {text}");
    }
    let noise = |text: &str| PLANE.to_owned() + &format!("\nH = [{text}]");
    let of_body = |text: &str| BODY.to_owned() + &format!("\nH = [{text}]");
    let damped = |rate: &str, bath: &str| format!("[damping]\n{rate}\n{bath}");
    for (system, bath, words) in [
        (noise("\"0.4*q^2\""), damped("rates = { p = 0.3 }", ""), "depends on the state"),
        (noise("\"0.4*q\""), through("\"0.4*q^2\""), "noise 1 is not of the bath"),
        (
            noise("\"0.2*q*p\""),
            through("\"sin(q)\""),
            "noise 1 is not of the bath, which has kT = 0.7",
        ),
        (noise("\"0.1*p^2\""), through("\"q^3\""), "noise 1 is not of the bath"),
        (of_body("\"0.1*y1\""), through("\"y2\", \"y3\""), "noise 1 is not of the bath"),
        (of_body("\"0.1*y1*y2\""), through("\"y3 + y1\""), "noise 1 is not of the bath"),
        (BODY.into(), damped("rate = 0.1", &through("\"y1\", \"y2\"")), "one temperature"),
        (
            BODY.into(),
            damped("rates = { y1 = 0.1 }", &through("\"y1\", \"y2\"")),
            "one temperature",
        ),
        (PLANE.into(), damped("rate = 0.1", &through("\"q^2\"")), "one temperature"),
        (
            BODY.into(),
            through("\"y1\"") + "\n[[bath]]\ntemperature = 0.8\nthrough = [\"y2\"]",
            "one temperature",
        ),
        (
            BODY.into(),
            through("\"y1\"") + "\n[[bath]]\ntemperature = 7\nthrough = [\"y3*y1\"]",
            "one temperature",
        ),
        (noise("\"0.4*q\""), through("\"0.4*p\""), "noise 1 is not of the bath"),
    ] {
        let bath =
            if bath.contains("[[bath]]") { bath.replacen("[bath]", "[[bath]]", 1) } else { bath };
        let initial = if system.contains("y[1..3]") { unit } else { "[1, 0.2]" };
        let (found, text) = inspected(&system, &bath, initial);
        assert!(
            found["beta"].is_null() && text.contains("No heat bath"),
            "{system} {bath}: {text}"
        );
        assert!(text.contains(words), "{system} {bath}, {words}: {text}");
    }
    // Noises that do not reach all of a leaf, and an energy that does not hold the state.
    let turns = "state = [\"x\", \"y\", \"z\"]\nB = \"rigid\"\nH0 = \"x^2/2 + y^2/2 + z^2\"";
    let two = "state = [\"q[1..2]\", \"p[1..2]\"]\nB = \"canonical\"\n\
               H0 = \"(p1^2 + p2^2 + q1^2 + q2^2)/2\"";
    let falls = "state = [\"q\", \"p\"]\nB = \"canonical\"\nH0 = \"p^2/2 - q^2/2 + q\"";
    let angle = "state = [\"q\", \"p\"]\nB = \"canonical\"\nH0 = \"p^2/2 - cos(q)\"";
    let friction = bath("friction = { p1 = 0.3 }");
    for (system, bath, initial, words) in [
        (turns, through("\"z\""), unit, "every function of H0 is stationary"),
        (two, friction, "[1, 0, 0, 0.3]", "reach 2 of 4 directions of a leaf, not q2, p2"),
        (falls, bath("friction = { p = 1 }"), "[0, 0]", "it has no integral"),
        (angle, bath("friction = { p = 1 }"), "[0, 0]", "no integral, unless q is an angle"),
    ] {
        let (_, text) = inspected(system, &bath, initial);
        assert!(text.contains(words), "{system} {bath}: {text}");
    }
}

#[test]
fn what_a_bath_cannot_be_is_refused_at_its_place() {
    let bath = "[bath]\ntemperature = 0.7\nthrough = [\"q*p\"]";
    let right = scene(PLANE, bath, "[1, 0]", "\"q^2\"", 0.1);
    for (from, to, words) in [
        ("0.7\n", "\"q\"\n", ["line 6, column 16", "depends on t and parameters alone"]),
        ("0.7\n", "-1\n", ["line 6, column 15", "must be positive, got -1"]),
        ("0.7\n", "0\n", ["line 6, column 15", "must be positive, got 0"]),
        ("through = [\"q*p\"]", "", ["line 6, column 15", "`friction` on momenta, `through`"]),
        ("q*p", "q*r", ["line 6", "unknown name `r`"]),
        ("through = [\"q*p\"]", "transverse = { s = 1 }", ["line 7, column 16", "is no spin"]),
        ("[bath]", "[damping]\nrate = 1\ntemperature = 1\n[bath]", ["line 7", "its own: [bath]"]),
    ] {
        let scene = right.replacen(from, to, 1);
        assert_ne!(scene, right, "{from}");
        fails(with_scene(&scene).path(), &["run", "scene.toml"], 2, &words);
    }
}

/// Test functions may be named on the command line; without any it is components and H₀.
#[test]
fn averages_are_asked_for_without_ceremony() {
    let bath = "[bath]\ntemperature = 0.7\nfriction = { p = 1 }";
    let text = scene(PLANE, bath, "[1, 0]", "\"q\"", 0.1);
    let plain = text.split("[expect]").next().unwrap();
    let folder = with_scene(plain);
    let found = json(folder.path(), &["equilibrium", "scene.toml", "--json", "--out", "a"]);
    let names = |found: &Value| {
        let all = found["estimates"].as_array().unwrap().iter();
        all.map(|of| of["of"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(names(&found), ["q", "p", "H0"]);
    // ⟨H₀⟩ = ½kT + ¼kT and Var H₀ = (½ + ¼)kT², so that the heat capacity is ¾.
    assert!(off(&found, 2, 0.75 * 0.7) < MISSES, "{found:#}");
    let [capacity, half] = [0, 1].map(|k| found["heat_capacity"][k].as_f64().unwrap());
    assert!((capacity - 0.75).abs() < MISSES * half, "{found:#}");
    let of = ["--of", "q^4", "--of", "min(q, p)", "--accuracy", "0.02", "--out", "b", "--json"];
    let found = json(folder.path(), &[&["equilibrium", "scene.toml"], &of[..]].concat());
    assert_eq!(names(&found), ["q^4", "min(q, p)"]);
    assert!(off(&found, 0, 0.7) < MISSES, "{found:#}");
    let arguments = ["equilibrium", "scene.toml", "--of", "q^^2"];
    fails(folder.path(), &arguments, 2, &["--of: ", "missing before `^`"]);
}

/// A chain that begins where H₀ is no number fails, and nobody waits for it.
#[test]
fn chains_without_an_energy_fail() {
    let log = "state = [\"q\", \"p\"]\nB = \"canonical\"\nH0 = \"p^2/2 - ln(q) + q^2/2\"";
    let bath = "[bath]\ntemperature = 1\nfriction = { p = 1 }";
    let folder = with_scene(&scene(log, bath, "[\"1 + 0.6*z1\", 0]", "\"q\"", 0.05));
    let output = run(folder.path(), &["equilibrium", "scene.toml", "--path-steps", "3e6"]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.code() == Some(1) && text.contains("chains failed"), "{text}");
}
