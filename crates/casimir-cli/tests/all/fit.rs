//! Parameters from data: closed forms, combinations that data do not show, wrong models and tables.

use std::{fs, path::Path};

use scenes::{Changes, Scene, Source};
use serde_json::Value;

use crate::common::{fails, json, run, with_scene};
#[cfg(unix)]
use crate::parts::signalled;

/// q − ip = e^{i(wt + sW)}: E[q] = e^{−s²t/2} cos wt.
pub const KUBO: &str = r#"
[system]
state = ["q", "p"]
B = "canonical"
H0 = "w*(q^2 + p^2)/2"
H = ["s*(q^2 + p^2)/2"]
parameters = { w = 1.2, s = 0.4 }
[run]
initial = [1, 0]
until = 2
steps = 64
[fit]
parameters = ["w", "s"]
"#;

/// dp = −f p dt − s dW from p = 1: normal, with mean e^{−ft} and variance s²(1 − e^{−2ft})/2f.
const ORNSTEIN: &str = r#"
[system]
state = ["q", "p"]
B = "canonical"
H0 = "p^2/2"
H = ["s*q"]
parameters = { f = 0.7, s = 0.5 }
[damping]
rates = { p = "f" }
[run]
initial = [0, 1]
until = 9
steps = 64
"#;

/// A scene of a text.
pub fn scene(text: &str) -> Scene {
    let source = Source::new("scene.toml", text);
    Scene::new(source, &Changes::default()).expect("a scene")
}

/// A table of moments at four times, each known to `error`.
fn table(observable: &str, error: f64, of: &[(&str, &dyn Fn(f64) -> f64)]) -> String {
    let mut text = String::from("time,observable,statistic,value,error\n");
    for t in [0.5, 1.0, 1.5, 2.0] {
        for (statistic, value) in of {
            text += &format!("{t:?},{observable},{statistic},{:?},{error}\n", value(t));
        }
    }
    text
}

/// E[q] of Kubo's oscillator.
fn mean_q(w: f64, s: f64) -> impl Fn(f64) -> f64 {
    move |t| (-0.5 * s * s * t).exp() * (w * t).cos()
}

/// Var q of Kubo's oscillator: E[q²] = (1 + e^{−2s²t} cos 2wt)/2.
fn variance_q(w: f64, s: f64) -> impl Fn(f64) -> f64 {
    move |t| {
        let square = 0.5 * (1.0 + (-2.0 * s * s * t).exp() * (2.0 * w * t).cos());
        square - mean_q(w, s)(t).powi(2)
    }
}

fn fit(text: &str, data: &str, arguments: &[&str]) -> Value {
    let folder = with_scene(text);
    fs::write(folder.path().join("data.csv"), data).expect("a file");
    let all = [&["fit", "scene.toml", "data.csv", "--json"], arguments].concat();
    json(folder.path(), &all)
}

/// Asserts parameters whose data have no error: what is left is Monte Carlo, at most 4.5 standard
/// errors (7e-6 for each), and the bias.
#[track_caller]
fn are(found: &Value, exact: &[f64]) {
    for (one, exact) in found["parameters"].as_array().unwrap().iter().zip(exact) {
        let [value, error, bias] =
            ["value", "monte_carlo", "bias_bound"].map(|key| one[key].as_f64().unwrap());
        assert!((value - exact).abs() < 4.5 * error + bias, "{exact}: {one}");
    }
    assert!(found["probability"].as_f64().unwrap() > 0.5, "{found}");
}

#[test]
fn parameters_are_those_of_closed_forms() {
    let data =
        table("q", 0.01, &[("mean", &mean_q(1.0, 0.5)), ("variance", &variance_q(1.0, 0.5))]);
    let found = fit(KUBO, &data, &[]);
    are(&found, &[1.0, 0.5]);
    // (JᵀJ)⁻¹ of the closed forms. Other errors add a tenth at most.
    for (k, exact) in [9.5238e-3, 1.652_60e-2].into_iter().enumerate() {
        let half = found["parameters"][k]["half_width"].as_f64().unwrap();
        assert!((0.98..1.2).contains(&(half / exact)), "{half} {exact}");
    }
    // The same bits for any number of threads.
    let but_time = |mut found: Value| {
        found["seconds"] = Value::Null;
        found
    };
    let alone = fit(KUBO, &data, &["--threads", "1"]);
    assert_eq!(but_time(found), but_time(alone));
    // Few paths widen the intervals, which is said, and are no failure.
    let few = fit(KUBO, &data, &["--path-steps", "1e5"]);
    assert!(
        few["reached"] == true && few["warnings"][0]["what"].as_str().unwrap().contains("widen")
    );
    // Of normal laws; the fit begins elsewhere.
    let deviation = |t: f64| 0.6 * ((1.0 - (-1.8 * t).exp()) / 1.8f64).sqrt();
    let quantile = |z: f64| move |t: f64| (-0.9 * t).exp() + z * deviation(t);
    let [low, high] = [quantile(-1.644_853_627), quantile(1.644_853_627)];
    let data = table("p", 0.02, &[("q0.05", &low), ("q0.95", &high), ("q0.5", &quantile(0.0))]);
    are(&fit(ORNSTEIN, &data, &["--of", "f,s"]), &[0.9, 0.6]);
}

/// A rotation that turns sixteen times: as often as there are steps in a unit of time where nobody
/// asks for it, and then friction does not act. Averages over a turn are right to g/4w.
#[test]
fn steps_follow_the_fastest_motion() {
    let text = ORNSTEIN
        .replace("\"p^2/2\"", "\"16*pi*(p^2 + q^2)\"")
        .replace("s = 0.5", "s = 0.1")
        .replace("[run]", "[observe]\ne = \"q^2 + p^2\"\n[run]");
    let exact = |t: f64| (-t).exp() + 0.01 * (1.0 - (-t).exp());
    let data = table("e", 0.002, &[("mean", &exact)]);
    let found = &fit(&text, &data, &["--of", "f"])["parameters"][0];
    assert!((found["value"].as_f64().unwrap() - 1.0).abs() < 0.01, "{found}");
}

#[test]
fn combinations_that_data_do_not_show_are_named() {
    let data = table("q", 0.01, &[("mean", &mean_q(1.0, 0.5))]);
    let product = KUBO.replace("\"w*(q", "\"w*v*(q").replace("w = 1.2", "v = 0.5, w = 2.2");
    let sum =
        KUBO.replace("2)/2\"]", "2)/2\", \"r*(q^2 + p^2)/2\"]").replace("w = ", "r = 0.4, w = ");
    for (scene, of, words) in [
        // 2.2 dv + 0.5 dw moves wv to 1.
        (product, "v,w", "they change with v + 0."),
        // r² + s² alone.
        (sum, "r,s", "they change with r + "),
        (KUBO.replace("w = 1.2", "u = 3, w = 1.2"), "w,u", "they do not depend on `u`; fix it"),
        // Noise on p alone moves no mean of q, but it does in a sample.
        (
            KUBO.replace("2)/2\"]", "2)/2\", \"r*q\"]").replace("w = ", "r = 0.4, w = "),
            "w,r",
            "they change with `r` by no more than sampling errors; fix it",
        ),
    ] {
        let folder = with_scene(&scene);
        fs::write(folder.path().join("data.csv"), &data).expect("a file");
        let arguments = ["fit", "scene.toml", "data.csv", "--of", of, "--path-steps", "1e7"];
        fails(folder.path(), &arguments, 1, &[words]);
    }
}

#[test]
fn a_wrong_model_is_refused() {
    // Damped data; without damping no frequency and noise give the mean and the variance.
    let damped = |t: f64| (-0.2 * t).exp() * mean_q(1.0, 0.5)(t);
    let variance = |t: f64| (-0.4 * t).exp() * variance_q(1.0, 0.5)(t);
    let data = table("q", 0.01, &[("mean", &damped), ("variance", &variance)]);
    let folder = with_scene(KUBO);
    fs::write(folder.path().join("data.csv"), &data).expect("a file");
    let found = run(folder.path(), &["fit", "scene.toml", "data.csv", "--json"]);
    assert_eq!(found.status.code(), Some(1));
    let found: Value = serde_json::from_slice(&found.stdout).expect("JSON");
    assert!(found["probability"].as_f64().unwrap() < 1e-3, "{found}");
    assert_eq!(found["warnings"][0]["what"], "the model does not fit the data");
    // With the damping it is right.
    let right = KUBO.replace("[run]", "[damping]\nrate = 0.2\n[run]");
    are(&fit(&right, &data, &[]), &[1.0, 0.5]);
}

#[test]
fn wrong_data_and_parameters_are_refused_with_their_place() {
    let data = table("q", 0.01, &[("mean", &mean_q(1.0, 0.5))]);
    let kink = KUBO.replace("w*(q^2 + p^2)/2", "p^2/2 + w*abs(q)");
    // By parameters of the drift there are likelihood ratios.
    let jump = ORNSTEIN.to_owned() + "[fit]\nparameters = \"f\"\n[observe]\na = \"p > 0.5\"\n";
    for (scene, from, to, words) in [
        (KUBO, "1.0,q,", "1.0,x,", "line 3, column 5: no observable `x`; there are p, q"),
        (
            KUBO,
            "1.0,q,mean",
            "1.0,q,middle",
            "line 3, column 7: `middle` is neither mean, variance",
        ),
        (KUBO, "1.0,q,mean", "1.0,q,q1.5", "`q1.5` is neither"),
        (KUBO, "2.0,q", "late,q", "line 5, column 1: `late` in the column `time` is not a number"),
        (KUBO, "0.01\n1.0", "0\n1.0", "line 2, column 31: an error must be positive, got 0"),
        (KUBO, "0.01\n1.0", "0.01,3\n1.0", "line: 2, byte: 38): found record with 6 fields"),
        (KUBO, "time,", "when,", "no column `t` or `time`"),
        (KUBO, "1.0,q,mean,", "1.0,q,variance,-", "a variance must be at least 0, got -0."),
        (KUBO, "2.0,q", "-2,q", "a time must be at least 0 and finite, got -2"),
        (KUBO, "2.0,q", "1.9999,q", "the times of the data are not multiples"),
        (KUBO, "time,observable", "time,x", "no observable `x`"),
        (KUBO, "time,observable,statistic,value,error\n", "t,q\n1,0.5\n", "line: "),
        (&kink, "time", "time", "whose field jumps"),
        (&jump, "0.5,q,", "0.5,a,", "moments have no derivative: a is no smooth function"),
        (
            &KUBO.replace("\"w\", \"s\"", "\"x\""),
            "time",
            "time",
            "no parameter `x` to fit; there are",
        ),
        (&KUBO.replace("\"w\", \"s\"", ""), "time", "time", "nothing is fitted: name parameters"),
    ] {
        let folder = with_scene(scene);
        fs::write(folder.path().join("data.csv"), data.replacen(from, to, 1)).expect("a file");
        fails(folder.path(), &["fit", "scene.toml", "data.csv"], 2, &[words]);
    }
    let few = "t,q\n1,0.5\n1,0.6\n";
    let folder = with_scene(KUBO);
    fs::write(folder.path().join("data.csv"), few).expect("a file");
    let words = "t = 1 has 2 observations, and their covariance takes 30";
    fails(folder.path(), &["fit", "scene.toml", "data.csv"], 2, &[words]);
}

/// A sweep has a fit at each combination.
#[test]
fn a_sweep_is_fitted_at_each_combination() {
    let data = table("q", 0.01, &[("mean", &mean_q(1.0, 0.5))]);
    let found = fit(KUBO, &data, &["--of", "s", "--set", "w=1,1.01"]);
    for (found, w) in found.as_array().unwrap().iter().zip([1.0, 1.01]) {
        assert!(found["varied"]["w"] == w && found["parameters"][0]["name"] == "s", "{found}");
    }
    are(&found[0], &[0.5]);
}

/// What is stopped or killed goes on with the same data, to the same bits.
#[cfg(unix)]
#[test]
fn an_interrupted_fit_goes_on() {
    // No number of paths is enough.
    let data =
        table("q", 1e-5, &[("mean", &mean_q(1.0, 0.5)), ("variance", &variance_q(1.0, 0.5))]);
    let folder = with_scene(KUBO);
    let path = folder.path();
    fs::write(path.join("data.csv"), &data).expect("a file");
    let words = ["fit", "scene.toml", "data.csv", "--path-steps", "6e7", "--threads", "1"];
    let found = |folder: &Path| {
        let output = run(folder, &[&words[..], &["--json"]].concat());
        let mut json: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        json["seconds"] = Value::Null;
        json
    };
    // There is work left after 200 ms, and a busy machine may have done none.
    let mut stopped = [200, 400, 800].into_iter().map(|wait| signalled(path, &words, "-INT", wait));
    let (code, _) = stopped.find(|(_, said)| said.contains("goes on")).unwrap_or_default();
    assert_eq!(code, Some(130));
    fs::write(path.join("data.csv"), data.replacen("0.00001", "0.00002", 1)).expect("a file");
    fails(path, &words, 1, &["is of another computation"]);
    fs::write(path.join("data.csv"), &data).expect("a file");
    signalled(path, &words, "-KILL", 300);
    let other = with_scene(KUBO);
    fs::write(other.path().join("data.csv"), &data).expect("a file");
    assert_eq!(found(path), found(other.path()));
    assert!(!path.join("scene-fit/moments.bin").exists());
}
