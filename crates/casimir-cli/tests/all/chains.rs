//! Chains that stay in wells, and growth that is not exponential.

use serde_json::Value;

use crate::common::{casimir, fails, json, run, succeeds, with_scene};

/// What `casimir` finds of a scene with a seed, and whether it is sure.
fn found(scene: &str, command: &str, arguments: &[&str]) -> Value {
    let folder = with_scene(scene);
    let arguments = [&[command, "scene.toml", "--json"], arguments].concat();
    let output = casimir(folder.path()).args(arguments).output().unwrap();
    serde_json::from_slice(&output.stdout).unwrap()
}

fn number(found: &Value, k: usize, key: &str) -> f64 {
    found["estimates"][k][key].as_f64().unwrap()
}

fn contains(found: &Value, k: usize, exact: f64) -> bool {
    (number(found, k, "lo")..=number(found, k, "hi")).contains(&exact)
}

/// A tilted double well, 20 kT deep.
const WELLS: &str = r#"
[system]
state = ["q", "p"]
B = "canonical"
H0 = "p^2/2 + (q^2 - 1)^2 + 0.05*q"
[bath]
friction = { p = 1 }
temperature = 0.05
[run]
initial = [1, 0]
until = 20
steps = 800
[expect]
of = ["q^2"]
accuracy = 0.005
"#;

#[test]
fn no_move_crosses_a_wall_of_infinite_energy() {
    // Means over q > 0 of e^{−q²/2} times e^{−0.05/q}, e^{−0.01/q} and q, by quadrature and in
    // closed form; over all q where H₀ is −∞ at 0, or has a limit.
    for (more, exact) in [
        ("0.05/abs(q)", 0.874_2),
        ("0.01/abs(q)", 0.821_5),
        ("-ln(abs(q))", 1.253_314),
        ("0.3*ln(abs(q))", 0.0),
        ("q^2*ln(q^2)", 0.0),
    ] {
        let energy = format!("q^2/2 + {more}\"");
        let scene = WELLS.replace("(q^2 - 1)^2 + 0.05*q\"", &energy).replace("= 0.05\n", "= 1\n");
        let scene = scene.replace("\"q^2\"", "\"q\"").replace("= 0.005", "= 0.04");
        let told = found(&scene, "equilibrium", &[]);
        assert!(told["reached"] == true && contains(&told, 0, exact), "{more}: {told:#}");
    }
    // The radius in the plane, r e^{−r²/2}.
    let polar = "[system]\nstate = [\"r\", \"th\", \"pr\", \"L\"]\nB = \"canonical\"\n\
                 H0 = \"pr^2/2 + L^2/(2*r^2) + r^2/2\"\n[bath]\ntemperature = 1\n\
                 through = [\"r\", \"th\"]\n[run]\ninitial = [1, 0, 0, 0.5]\nuntil = 20\n\
                 steps = 2000\n[expect]\nof = [\"r\"]\naccuracy = 0.04\n";
    let told = found(polar, "equilibrium", &[]);
    assert!(told["reached"] == true && contains(&told, 0, 1.253_314), "{told:#}");
}

#[test]
fn wells_that_no_chain_leaves_are_seen_whatever_is_averaged() {
    // q² is 0.025 larger in the well that e^{-0.1/kT} = 0.14 as many chains should be in as in the
    // other one; about as many are. A twin without tilt has the same q² in both.
    for seed in ["1", "2"] {
        let arguments = ["--seed", seed, "--path-steps", "3e6"];
        let told = found(WELLS, "equilibrium", &arguments);
        let why = told["estimates"][0]["unknown"]["what"].as_str().unwrap();
        assert!(why.contains("stay in wells") && told["reached"] == false, "{told:#}");
        let even = WELLS.replace("+ 0.05*q", "");
        let told = found(&even, "equilibrium", &arguments);
        assert!(told["reached"] == true && contains(&told, 0, EVEN), "{told:#}");
    }
    // An angle that diffuses keeps its value as well, and p foretells it, but not the reverse.
    let angle = WELLS.replace("(q^2 - 1)^2 + 0.05*q", "1 - cos(q)").replace("= 0.05\n", "= 1\n");
    let angle = angle.replace("\"q^2\"", "\"cos(q)\", \"p\"").replace("= 0.005", "= 0.02");
    let told = found(&angle, "equilibrium", &[]);
    // I₁(1)/I₀(1).
    assert!(told["reached"] == true && contains(&told, 0, 0.446_389_965), "{told:#}");
    // A random parameter, which is conserved, is none that chains should exchange.
    let random = WELLS.replace("[\"q\", \"p\"]", "[\"q\", \"p\", \"w\", \"v\"]");
    let random = random.replace("(q^2 - 1)^2 + 0.05*q", "w*q^2/2").replace("= 0.05\n", "= 1\n");
    let random = random.replace("[1, 0]", "[1, 0, \"1 + u1\", 0]").replace("= 0.005", "= 0.05");
    let random = random.replace("\"canonical\"", "\"canonical(q,p) + canonical(w,v)\"");
    let told = found(&random, "equilibrium", &[]);
    // The mean of 1/w.
    assert!(told["reached"] == true && contains(&told, 0, std::f64::consts::LN_2), "{told:#}");
}

/// Spins along an axis that is steep beside kT.
const SPINS: &str = r#"
[system]
name = "spin-lattice"
[system.parameters]
sizes = [4]
exchange = 0.2
anisotropy = 6
field = [0, 0, 0.1]
[bath]
transverse = { s = 0.5 }
temperature = 0.2
[run]
initial = [0, "sin(1.5)", "cos(1.5)"]
until = 20
steps = 800
[expect]
of = ["energy"]
accuracy = 0.02
"#;

#[test]
fn spins_that_stay_on_their_side_are_seen_in_the_energy() {
    let told = found(SPINS, "equilibrium", &["--path-steps", "3e6"]);
    assert!(
        told["reached"] == false && told["estimates"][0]["unknown"]["what"].is_string(),
        "{told:#}"
    );
    // Without anisotropy nothing stays.
    let free = SPINS.replace("anisotropy = 6\n", "").replace("0.02\n", "0.2\n");
    let told = found(&free, "equilibrium", &["--path-steps", "3e7"]);
    assert!(told["reached"] == true && told["estimates"][0]["unknown"].is_null(), "{told:#}");
}

#[test]
fn one_chain_that_fails_is_named() {
    // Below a barrier of 5.6 kT the energy has no bound: some chains leave, at every step size.
    let open = WELLS.replace("(q^2 - 1)^2 + 0.05*q", "q^2/2 - q^3/3").replace("[1, 0]", "[0, 0]");
    let open = open.replace("until = 20", "until = 10").replace("steps = 800", "steps = 1000");
    let open = open.replace("= 0.05\n", "= 0.03\n").replace("\"q^2\"", "\"q\"");
    let folder = with_scene(&open.replace("= 0.005", "= 0.002"));
    let output = run(
        folder.path(),
        &["equilibrium", "scene.toml", "--seed", "5", "--path-steps", "2e6", "--scheme", "sexp"],
    );
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("cannot tell: 1 of 256 chains failed"), "{said}");
    assert_eq!(output.status.code(), Some(1));
}

/// ⟨q²⟩ of (q² − 1)² at kT = 0.05, by quadrature.
const EVEN: f64 = 0.986_975_055;

/// Two pairs that do not see each other: the first turns in noise, the second is a saddle.
const SPLIT: &str = r#"
[system]
state = ["q1", "p1", "q2", "p2"]
B = "canonical(q1,p1) + canonical(q2,p2)"
H0 = "(p1^2 + q1^2 + p2^2 - q2^2)/2"
H = ["0.1*q1"]
[run]
initial = [0, 0, 0, 0]
until = 5
steps = 256
"#;

#[test]
fn tangent_vectors_are_in_no_subspace_that_a_system_keeps() {
    let told = found(SPLIT, "lyapunov", &["--count", "4", "--accuracy", "0.02", "--chains", "32"]);
    for (k, exact) in [1.0, 0.0, 0.0, -1.0].into_iter().enumerate() {
        assert!((number(&told, k, "value") - exact).abs() < 0.02, "{told:#}");
    }
    assert!(told["reached"] == true && number(&told, 0, "half_width") < 1e-2, "{told:#}");
}

/// Two pairs that stretch by e^{0.1t} and e^{0.05t}, each with noise: chains that are shorter than
/// both need to part have an exponent between (0.065 to 0.076 ± 0.008 in four seeds).
#[test]
fn the_leading_direction_is_found_among_split_ones() {
    let scene = r#"
[system]
state = ["q1", "q2", "p1", "p2"]
B = "canonical"
H0 = "0.1*q1*p1 + 0.05*q2*p2"
H = ["0.3*q1*p1", "0.3*q2*p2"]
[run]
initial = [1, 1, 1, 1]
until = 10
steps = 200
"#;
    for seed in ["1", "2"] {
        let told = found(scene, "lyapunov", &["--seed", seed]);
        assert!(contains(&told, 0, 0.1) && told["reached"] == true, "{told:#}");
    }
}

/// All chains have the same phase, so that no standard error shows where in its period ln|v| ends:
/// without its range the interval is −0.1954 ± 0.0031.
#[test]
fn a_period_of_the_growth_is_in_the_interval() {
    let scene = r#"
[system]
state = ["q1", "q2", "p1", "p2"]
B = "canonical(q1,p1) + canonical(q2,p2)"
H0 = "(p1^2 + p2^2 + q1^2 + q2^2)/2"
H = ["0.1*q1", "0.2*q2"]
[damping]
rates = { p1 = 1.0, p2 = 0.4 }
[run]
initial = [1, 1, 0, 0]
until = 40
steps = 2000
"#;
    let told = found(scene, "lyapunov", &["--accuracy", "0.01"]);
    assert!(contains(&told, 0, -0.2) && told["reached"] == true, "{told:#}");
    // Around an ellipse with axes of 3 and 1 ln|v| moves within ln 3, and the interval is twice as
    // wide on each side. Less a line it moves within 1/6 more or less, which is half a period's
    // part of the line, and within 1/10 less at the ends of batches, five in a period.
    let ellipse = r#"
[system]
state = ["q", "p"]
B = "canonical"
H0 = "0.9*p^2 + 0.1*q^2"
H = ["0.1*q"]
[run]
initial = [0, 0]
until = 16
steps = 160
"#;
    let told = found(ellipse, "lyapunov", &["--accuracy", "0.2"]);
    let kept = told["time"].as_f64().unwrap() - told["burn_in"].as_f64().unwrap();
    let range = number(&told, 0, "sampling") * kept / (2.0 * 3f64.ln());
    assert!(range > 0.73 && range < 1.17 && contains(&told, 0, 0.0), "{range}: {told:#}");
}

#[test]
fn a_power_of_time_is_no_exponent() {
    // A body whose energy is all there is to its noise: neighbours part like t.
    let body = r#"
[system]
state = ["M[1..3]"]
B = "rigid(M)"
H0 = "M1^2/4 + M2^2/2 + 3*M3^2/4"
H = ["(M1^2/4 + M2^2/2 + 3*M3^2/4)/2"]
[run]
initial = [0.6, 0.3, 0.7]
until = 16
steps = 512
"#;
    for seed in ["1", "2", "3"] {
        let told = found(body, "lyapunov", &["--seed", seed, "--accuracy", "0.2"]);
        assert!(contains(&told, 0, 0.0) && number(&told, 0, "value") > 0.0, "{told:#}");
    }
    let output = run(with_scene(body).path(), &["lyapunov", "scene.toml", "--accuracy", "0.2"]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.contains("λ1 ≤ ") && text.contains(", growth "), "{text}");
    // A real exponent stays: ½σ²/4 of a weak noise σ = 0.4 on the frequency.
    let kubo = r#"
[system]
state = ["q", "p"]
B = "canonical"
H0 = "(q^2 + p^2)/2"
H = ["0.4*q^2/2"]
[run]
initial = [0, 0]
until = 16
steps = 256
"#;
    let told = found(kubo, "lyapunov", &["--accuracy", "0.005"]);
    let seen = number(&told, 0, "lo") > 0.0 && number(&told, 0, "unsettled") == 0.0;
    assert!(seen && (number(&told, 0, "value") - 0.0199).abs() < 0.007, "{told:#}");
}

#[test]
fn averages_need_no_wish_and_have_digits_in_any_unit() {
    // In SI units: lengths of 1e-7 and times of 1e-6.
    let small = r#"
[system]
state = ["x", "p"]
B = "canonical"
H0 = "p^2/(2*m) + k*x^2/2"
parameters = { m = 1e-15, k = 1e-3 }
[bath]
friction = { p = 1e6 }
temperature = 4.14e-21
[run]
initial = [0, 0]
until = 2e-5
steps = 256
"#;
    let folder = with_scene(small);
    let text = succeeds(folder.path(), &["equilibrium", "scene.toml"]);
    assert!(text.contains("kT = 4.140e-21") && !text.contains("0.000"), "{text}");
    assert!(text.contains("H0 = 4.1") && text.contains("exact: Metropolis"), "{text}");
    let text = succeeds(folder.path(), &["equilibrium", "scene.toml", "--scheme", "sexp"]);
    assert!(text.contains("chains of length 2.75e-5, burn-in "), "{text}");
    let told = json(folder.path(), &["equilibrium", "scene.toml", "--json"]);
    assert!(told["reached"] == true && told["accuracy"].is_null(), "{told:#}");
    assert!(told["estimates"][0]["of"] == "x" && contains(&told, 0, 0.0), "{told:#}");
    let driven = small.replace("k*x^2/2", "k*x^2/2 - 1e-12*cos(1e6*t)*x");
    fails(with_scene(&driven).path(), &["lyapunov", "scene.toml"], 2, &["make its phase a"]);
}

/// Heat capacities and derivatives by β are covariances with H₀: unknown where H₀ is. Chains in a
/// cold double well, and those of spins of different lengths, whose covariance has the spread of
/// their leaves in it; the twin is one length, with C = x²(1/x² − 1/sinh²x) for x = 1/kT.
#[test]
fn heat_capacities_need_an_energy_that_is_known() {
    let spin = |start: &str| {
        format!(
            "[system]\nstate = [\"s[1..3]\"]\nB = \"spins\"\nH0 = \"-s3\"\n\
             [bath]\ntemperature = 0.5\ntransverse = {{ s = 0.2 }}\n\
             [run]\ninitial = [0, 0, {start}]\nuntil = 20\nsteps = 1000\n"
        )
    };
    let well = "[system]\nstate = [\"q\", \"p\"]\nB = \"canonical\"\n\
                H0 = \"p^2/2 + q^4 - 2*q^2 + 0.1*q\"\n\
                [bath]\ntemperature = 0.05\nfriction = { p = 0.5 }\n\
                [run]\ninitial = [0.3, 0]\nuntil = 20\nsteps = 1000\n";
    let found = |scene: &str, of: &str| {
        let arguments = ["equilibrium", "scene.toml", "--json", "--of", of, "--accuracy", "0.02"];
        json(with_scene(scene).path(), &arguments)
    };
    for (scene, of) in [(well, "p^2"), (&spin("\"1 + u1\""), "s1")] {
        let found = found(scene, of);
        assert!(found["heat_capacity"].is_null() && !found["energy"].is_null(), "{found:#}");
        assert!(found["estimates"][0]["by_beta"].is_null(), "{found:#}");
    }
    let found = found(&spin("1"), "s3");
    let [capacity, half] = [0, 1].map(|k| found["heat_capacity"][k].as_f64().unwrap());
    let exact = 1.0 - (2.0 / 2f64.sinh()).powi(2);
    assert!((capacity - exact).abs() < 1.6 * half && half < 0.05 && found["energy"].is_null());
    assert!(!found["estimates"][0]["by_beta"].is_null(), "{found:#}");
}

/// A pair of complex exponents turns tangents, by the same phase on all chains; an oscillator that
/// no noise reaches goes round. Neither is a drift, and the phase is in the interval.
#[test]
fn bounded_motion_is_no_drift() {
    let oscillator = "[system]\nstate = [\"q\", \"p\"]\nB = \"canonical\"\n\
                      H0 = \"p^2/2 + q^2/2\"\n[bath]\ntemperature = 1\nfriction = { p = 0.5 }\n\
                      [run]\ninitial = [0, 0]\nuntil = 20\nsteps = 2000\n";
    let arguments = ["lyapunov", "scene.toml", "--json", "--count", "2", "--path-steps", "2e7"];
    let found = json(with_scene(oscillator).path(), &arguments);
    let two = "[system]\nstate = [\"q[1..2]\", \"p[1..2]\"]\nB = \"canonical(q, p)\"\n\
               H0 = \"dot(p, p)/2 + dot(q, q)/2\"\n[bath]\ntemperature = 1\n\
               friction = { p1 = 0.5 }\n[run]\ninitial = [1, 2, 0, 0]\nuntil = 20\nsteps = 1000\n";
    let of = ["--json", "--of", "q1^2", "--of", "q2^2", "--accuracy", "0.02"];
    let turns = json(with_scene(two).path(), &[&["equilibrium", "scene.toml"], &of[..]].concat());
    for (found, k, exact) in
        [(&found, 0, -0.25), (&found, 1, -0.25), (&turns, 0, 1.0), (&turns, 1, 2.0)]
    {
        let number = |key: &str| found["estimates"][k][key].as_f64().unwrap();
        let off = (number("value") - exact).abs() / number("half_width");
        assert!(off < 1.6 && found["reached"] == true, "{k}: {found:#}");
    }
}

#[test]
fn energies_that_fall_without_bound_have_no_law() {
    for potential in ["- q^4", "- q^2/2", "+ q^3", "- exp(q)"] {
        let scene = format!(
            "[system]\nstate = [\"q\", \"p\"]\nB = \"canonical\"\nH0 = \"p^2/2 {potential}\"\n\
             [bath]\ntemperature = 1\nfriction = {{ p = 0.5 }}\n\
             [run]\ninitial = [0.1, 0]\nuntil = 10\nsteps = 200\n"
        );
        let folder = with_scene(&scene);
        let words = ["falls without bound along q", "no integral"];
        fails(folder.path(), &["equilibrium", "scene.toml", "--of", "q^2"], 1, &words);
    }
}
