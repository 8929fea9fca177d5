//! Averages over the stationary law, and Lyapunov exponents, against closed forms.
//!
//! An interval of 95 % that is 2.5 times as wide misses once in a million.

use std::{process::Stdio, thread, time::Duration};

use serde_json::Value;

use crate::common::{casimir, fails, json, run, succeeds, with_scene, without_bath};

const MISSES: f64 = 2.5;

/// A particle of mass m in a potential, in a bath.
fn bath(potential: &str, observed: &str, accuracy: f64) -> String {
    format!(
        r#"
[system]
state = ["q", "p"]
B = "canonical"
H0 = "p^2/(2*m) + {potential}"
parameters = {{ g = 1, kT = 0.8, m = 2 }}
[bath]
friction = {{ p = "g" }}
temperature = "kT"
[run]
initial = [0.5, 0]
until = 16
steps = 160
[expect]
of = [{observed}]
accuracy = {accuracy}
"#
    )
}

fn averaged(scene: &str) -> Value {
    json(with_scene(scene).path(), &["equilibrium", "scene.toml", "--json"])
}

/// How far average number k is from a value, in half-widths.
fn distance(found: &Value, k: usize, exact: f64) -> f64 {
    let number = |key: &str| found["estimates"][k][key].as_f64().unwrap();
    (number("value") - exact).abs() / number("half_width")
}

/// ∫f/∫1 over [−r, r] with the weight w.
fn mean(f: impl Fn(f64) -> f64, w: impl Fn(f64) -> f64, r: f64) -> f64 {
    let x: Vec<f64> = (0..4000).map(|k| r * (f64::from(k) + 0.5 - 2000.0) / 2000.0).collect();
    x.iter().map(|&x| f(x) * w(x)).sum::<f64>() / x.iter().map(|&x| w(x)).sum::<f64>()
}

#[test]
fn averages_of_baths_are_those_of_gibbs() {
    let kt = 0.8;
    let wells = mean(|q| q * q, |q| (-(q * q - 1.0f64).powi(2) / kt).exp(), 4.0);
    let cosine = mean(f64::cos, |q| (q.cos() / kt).exp(), std::f64::consts::PI);
    for (potential, of, exact) in
        [("q^2/2", "q^2", kt), ("(q^2 - 1)^2", "q^2", wells), ("1 - cos(q)", "cos(q)", cosine)]
    {
        let found = averaged(&bath(potential, &format!("\"{of}\", \"p^2/m\""), 0.05));
        assert!(found["reached"] == true && (found["kT"].as_f64().unwrap() - kt).abs() < 1e-9);
        assert!(distance(&found, 0, exact) < MISSES, "{potential}: {found:#}");
        assert!(distance(&found, 1, kt) < MISSES, "{potential}: {found:#}");
    }
    // The twins: noise that is too weak by √m, friction that is missing on one of two momenta.
    let weak = bath("q^2/2", "\"p^2/m\"", 0.05);
    let weak = without_bath(&weak);
    let weak = weak.replace("parameters", "H = [\"sqrt(2*g*kT)*q\"]\nparameters");
    assert!(distance(&averaged(&weak), 0, kt) > 2.0 * MISSES);
    let pair = r#"
[system]
state = ["q[1..2]", "p[1..2]"]
B = "canonical"
H0 = "(p1^2 + p2^2 + q1^2 + q2^2 + (q1 - q2)^2)/2"
H = ["sqrt(2*kT)*q1", "sqrt(2*kT)*q2"]
parameters = { kT = 0.8 }
[damping]
rates = { p1 = 1 }
[run]
initial = [0, 0, 0, 0]
until = 16
steps = 160
[expect]
of = ["p2^2"]
accuracy = 0.1
"#;
    assert!(distance(&averaged(pair), 0, kt) > 2.0 * MISSES);
    assert!(distance(&averaged(&pair.replace("p1 = 1", "p = 1")), 0, kt) < MISSES);
}

/// The law of p₁ is known; that of q₁, which q₂ pulls, is not.
#[test]
fn densities_are_drawn_beside_those_of_gibbs_where_these_are_known() {
    let scene = bath("p2^2/2 + q1^2 + q2^2 + q1*q2", "\"q1\", \"p1\"", 1.0);
    let scene = scene.replace(r#"["q", "p"]"#, r#"["q1", "q2", "p1", "p2"]"#);
    let scene = scene.replace("p^2/(2*m)", "p1^2/(2*m)").replace("[0.5, 0]", "[0.5, 0, 0, 0]");
    let folder = with_scene(&scene.replace("p = \"g\"", "p1 = \"g\", p2 = \"g\""));
    succeeds(folder.path(), &["equilibrium", "scene.toml"]);
    let known = ["q1", "p1"].map(|name| {
        let file = folder.path().join(format!("scene-equilibrium/density-{name}.svg"));
        std::fs::read_to_string(file).unwrap().contains("exp(-H0/kT)")
    });
    assert_eq!(known, [false, true]);
}

#[test]
fn steps_far_too_long_are_halved() {
    // At 4τ, 2τ and τ = 0.435 the means are 0.970, 0.920 and 0.970: their ends agree.
    let scene =
        bath("q^2/2", "\"q^2\"", 0.02).replace("m = 2", "m = 1").replace("kT = 0.8", "kT = 1");
    let scene = scene.replace("until = 16", "until = 111.36").replace("steps = 160", "steps = 256");
    for seed in ["1", "2", "3"] {
        let arguments = ["equilibrium", "scene.toml", "--json", "--scheme", "sexp", "--seed", seed];
        let found = json(with_scene(&scene).path(), &arguments);
        assert!(distance(&found, 0, 1.0) < MISSES, "{found:#}");
    }
    // Explicit steps that explode are too long as well.
    let steep = bath("q^4", "\"q^2\"", 0.02).replace("steps = 160", "steps = 32");
    let arguments = ["equilibrium", "scene.toml", "--json", "--scheme", "heun"];
    let found = json(with_scene(&steep).path(), &arguments);
    let exact = mean(|q| q * q, |q| (-q.powi(4) / 0.8).exp(), 4.0);
    assert!(distance(&found, 0, exact) < MISSES && found["chains"] == 256, "{found:#}");
    // What is conserved has no error, and what is no number is said.
    let lost = bath("q^2/2", "\"sqrt(q)\"", 0.1);
    let output = run(with_scene(&lost).path(), &["equilibrium", "scene.toml"]);
    assert!(String::from_utf8_lossy(&output.stdout).contains("cannot tell: it is not finite"));
    let kept = "[system]\nname = \"rigid-body\"\n[run]\ninitial = [0.8, 0, 0.6]\nuntil = 16\nsteps = \
                160\n[expect]\nof = [\"y1^2 + y2^2 + y3^2\"]\naccuracy = 0.01\n";
    let found = averaged(kept);
    assert!(found["reached"] == true && distance(&found, 0, 1.0) < 1.0, "{found:#}");
}

#[test]
fn noise_is_that_of_stratonovich() {
    let scene = r#"
[system]
state = ["q", "p"]
B = "canonical"
H0 = "(p^2 + q^2)/2"
H = ["s*q*p", "sqrt(2)*q"]
parameters = { s = 0.25 }
[damping]
rates = { p = 1 }
[run]
initial = [0, 0]
until = 16
steps = 160
[expect]
of = ["q^2", "p^2"]
accuracy = 0.02
"#;
    // The moments of the linear equation, and those by Itô.
    let s: f64 = 0.25 * 0.25;
    let q = 1.0 / ((1.0 - s) * (1.0 - s) - s);
    let ito = 2.0 / ((2.0 - s) * (1.0 - (1.0 + s) * s / 2.0) - s);
    let found = averaged(scene);
    assert!(distance(&found, 0, q) < MISSES && distance(&found, 1, q * (1.0 - s)) < MISSES);
    assert!(distance(&found, 0, ito) > 2.0 * MISSES, "{ito} {found:#}");
}

/// ⟨q²⟩ and ⟨p²⟩ at γ = ω = kT = 1: S = MSMᵀ + 2τccᵀ, where a step is D(ADy + bΔW) with D =
/// diag(1, e^{−τ/2}), M = DAD and c = Db.
fn stationary(tau: f64, step: impl Fn([f64; 2], f64) -> [f64; 2]) -> [f64; 2] {
    let half = (-0.5 * tau).exp();
    let damped = |[q, p]: [f64; 2]| [q, half * p];
    let column = |y, dw| damped(step(damped(y), dw));
    let [a, b, c] =
        [([1.0, 0.0], 0.0), ([0.0, 1.0], 0.0), ([0.0, 0.0], 1.0)].map(|(y, dw)| column(y, dw));
    let mut s = [0.0; 3];
    for _ in 0..(60.0 / tau) as usize {
        let [qq, qp, pp] = s;
        let entry = |i: usize, j: usize| {
            let cross = a[i] * b[j] + a[j] * b[i];
            a[i] * a[j] * qq + cross * qp + b[i] * b[j] * pp + 2.0 * tau * c[i] * c[j]
        };
        s = [entry(0, 0), entry(0, 1), entry(1, 1)];
    }
    [s[0], s[2]]
}

#[test]
fn the_bias_of_the_step_is_that_of_theory() {
    // `sexp` is Cayley's map here, and `sexp-li`, explicit for a constant B, Taylor's second.
    let cayley = |tau: f64| {
        move |[q, p]: [f64; 2], dw: f64| {
            let h = 0.5 * tau;
            let next = ((1.0 - h * h) * p - tau * q + dw) / (1.0 + h * h);
            [q + h * (p + next), next]
        }
    };
    let taylor = |tau: f64| {
        move |[q, p]: [f64; 2], dw: f64| {
            let s = 1.0 - 0.5 * tau * tau;
            [s * q + tau * (p + 0.5 * dw), s * p - tau * q + dw]
        }
    };
    let known = stationary(0.1, cayley(0.1));
    assert!((known[0] - 1.0 + 1.656e-3).abs() < 1e-6 && (known[1] - 1.0 + 4.154e-3).abs() < 1e-6);
    let scene = bath("q^2/2", "\"q^2\", \"p^2\"", 0.5).replace("m = 2", "m = 1");
    let scene = scene.replace("kT = 0.8", "kT = 1").replace("until = 16", "until = 19.2");
    let folder = with_scene(&scene.replace("steps = 160", "steps = 96"));
    for scheme in ["sexp", "sexp-li"] {
        // A bias below a part of so little accuracy is small: no step is halved.
        let chains = ["--chains", "8192"];
        let arguments = ["equilibrium", "scene.toml", "--json", "--scheme", scheme];
        let found = json(folder.path(), &[&arguments[..], &chains].concat());
        let [coarse, fine] = [0, 2].map(|level| {
            let tau = found["taus"][level].as_f64().unwrap();
            if scheme == "sexp" {
                stationary(tau, cayley(tau))
            } else {
                stationary(tau, taylor(tau))
            }
        });
        for k in 0..2 {
            let level = &found["estimates"][k]["levels"][0];
            let (difference, error) = (level[1].as_f64().unwrap(), level[2].as_f64().unwrap());
            let exact = coarse[k] - fine[k];
            assert!((difference - exact).abs() < 5.0 * error, "{scheme}: {difference} {exact}");
            // Another order would be seen.
            assert!(error < 0.2 * exact.abs(), "{scheme} {k}: {exact} ± {error}");
        }
    }
}

#[test]
fn a_start_that_is_forgotten_is_left_out_and_no_more() {
    // A free particle: p falls like e^{-t}, and as slowly forgets what it was, p² twice as fast.
    let scene = bath("0*q", "\"p\", \"p^2\"", 0.03).replace("[0.5, 0]", "[0, 1e14]");
    let scene = scene.replace("until = 16\nsteps = 160", "until = 8\nsteps = 80");
    let arguments = ["equilibrium", "scene.toml", "--json", "--scheme", "sexp"];
    let found = json(with_scene(&scene).path(), &arguments);
    assert!(found["reached"] == true && distance(&found, 1, 1.6) < MISSES, "{found:#}");
    let number = |k: usize, key: &str| found["estimates"][k][key].as_f64().unwrap();
    // The variance of 256 normal means has a relative error of √(2/255) = 0.089.
    for (k, exact) in [(0, 1.0), (1, 0.5)] {
        let ratio = number(k, "autocorrelation_time") / exact;
        assert!((ratio - 1.0).abs() < 4.5 * 0.089, "{ratio}: {found:#}");
    }
    // After a first time of 8, and as much until pairs are chosen, p is 1.1e7. It exceeds 3.5 standard errors of the mean of a batch of
    // 4 or 8 up to 16.1 or 16.5 from there. Twice the time to the end of that batch is left out.
    let [burn_in, time] = ["burn_in", "time"].map(|key| found[key].as_f64().unwrap());
    assert!(burn_in > 31.0 && burn_in < 2.0 * (17.5 + time / 24.0), "{burn_in} of {time}");
    // The mean at τ, or for the weak order one that at 2τ taken from twice that, and what the other
    // step sizes say of its error.
    let level = |n: usize, m: usize| found["estimates"][1]["levels"][n][m].as_f64().unwrap();
    let (coarse, middle, last) = (level(0, 1), level(1, 1), level(2, 0));
    let (value, bias) = (number(1, "value"), number(1, "bias"));
    let is_plain = value == last && bias >= coarse.abs() / 3.0;
    let is_extrapolated = (value - (last - middle)).abs() < 1e-12;
    let least = (coarse - 3.0 * middle).abs() - 1e-12;
    assert!(is_plain || is_extrapolated && bias >= least, "{found:#}");
    let whole = number(1, "sampling") + bias;
    assert!((number(1, "hi") - value - whole).abs() < 1e-12, "{found:#}");
}

#[test]
fn what_nobody_can_tell_is_said() {
    // 25 kT between the wells: no chain finds the other one, but for those that begin there.
    let stuck = bath("20*(q^2 - 1)^2", "\"q\"", 0.1).replace("steps = 160", "steps = 640");
    let folder = with_scene(&stuck.replace("until = 16", "until = 8"));
    let output = run(folder.path(), &["equilibrium", "scene.toml", "--path-steps", "2e6"]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.code() == Some(1) && text.contains("cannot tell: the chains are"),
        "{text}"
    );
    let equilibrium = ["equilibrium", "scene.toml", "--path-steps", "2e6", "--json"];
    let output = run(folder.path(), &equilibrium);
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let warnings = found["warnings"].to_string();
    assert!(warnings.contains("the chains are"), "{warnings}");
    // Nothing is stationary without friction.
    let free = without_bath(&bath("q^2/2", "\"p^2\"", 0.1));
    let free = free.replace("rates = { p = \"g\" }", "rate = 0");
    let free = free.replace("parameters", "H = [\"q\"]\nparameters");
    let folder = with_scene(&free);
    let output = run(folder.path(), &["equilibrium", "scene.toml", "--path-steps", "1e7"]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.contains("cannot tell"), "{text}");
    for (from, to, words) in [
        ("rates = { p = \"g\" }", "rate = \"0.1*t\"", "depends on time"),
        // The same at both ends.
        ("rates = { p = \"g\" }", "rate = \"1 + cos(pi*t/8)/2\"", "depends on time"),
        ("[expect]", "[nothing]", "unknown"),
        ("accuracy = 0.1", "accuracy = -1", "accuracy must be positive"),
    ] {
        let scene = without_bath(&bath("q^2/2", "\"q\"", 0.1)).replace(from, to);
        fails(with_scene(&scene).path(), &["equilibrium", "scene.toml"], 2, &[words]);
    }
    let still = without_bath(&bath("q^2/2", "\"q\"", 0.1));
    let same = "all chains are the same";
    fails(with_scene(&still).path(), &["equilibrium", "scene.toml"], 2, &[same]);
    fails(with_scene(&free).path(), &["lyapunov", "scene.toml", "--count", "3"], 2, &["got 3"]);
}

#[test]
fn chains_go_on_from_their_checkpoint() {
    let scene = bath("(q^2 - 1)^2", "\"q\", \"p^2\"", 0.02);
    let found = |folder: &tempfile::TempDir| {
        let arguments = ["equilibrium", "scene.toml", "--threads", "1", "--scheme", "sexp"];
        let text = succeeds(folder.path(), &arguments);
        let lines = text.lines().filter(|line| !line.ends_with(" s") && !line.contains("figure"));
        lines.map(str::to_owned).collect::<Vec<_>>()
    };
    let undisturbed = found(&with_scene(&scene));
    let folder = with_scene(&scene);
    let mut child = casimir(folder.path())
        .args(["equilibrium", "scene.toml", "--threads", "1", "--scheme", "sexp"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    thread::sleep(Duration::from_millis(150));
    let sent = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(sent.unwrap().success() && child.wait().unwrap().code() == Some(130));
    assert!(folder.path().join("scene-equilibrium/chains.bin").exists());
    assert_eq!(found(&folder), undisturbed);
    assert!(!folder.path().join("scene-equilibrium/chains.bin").exists());
}

#[test]
fn exponents_are_those_of_theory() {
    let scene = r#"
[system]
state = ["q", "p"]
B = "canonical"
H0 = "(q^2 + p^2)/2"
H = ["q^2/2"]
[damping]
rates = { p = 0.3 }
[run]
initial = [0, 0]
until = 16
steps = 320
"#;
    // λ₁ + γ/2 = ½∫√v w/∫w/√v with w = exp(−2(av + v³/12)/σ²), a = 1 − γ²/4, σ = 1 (Imkeller and
    // Lederer 1999), here with v = x².
    let weight = |x: f64| (-2.0 * (0.9775 * x * x + x.powi(6) / 12.0)).exp();
    let exact = 0.5 * mean(|x| x * x, weight, 4.0) - 0.15;
    let found = json(
        with_scene(scene).path(),
        &["lyapunov", "scene.toml", "--count", "2", "--accuracy", "3e-3", "--json"],
    );
    assert!(distance(&found, 0, exact) < MISSES, "{exact}: {found:#}");
    assert!(distance(&found, 1, -0.3 - exact) < MISSES, "{exact}: {found:#}");
    assert!((found["estimates"][2]["value"].as_f64().unwrap() + 0.3).abs() < 1e-12);
    // The twin: the exponent without its friction.
    assert!(distance(&found, 0, exact + 0.15) > 2.0 * MISSES);
    // Of nonlinear systems, too, volume contracts.
    let pendulum = bath("1 - cos(q)", "\"q\"", 1.0);
    let text = succeeds(
        with_scene(&pendulum).path(),
        &["lyapunov", "scene.toml", "--count", "2", "--accuracy", "0.02"],
    );
    assert!(text.contains("volume contracts by -Σγᵢ = -1: the sum differs by"), "{text}");
}
