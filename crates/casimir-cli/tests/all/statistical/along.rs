//! Integrals, averages and events along paths.

use serde_json::Value;

use crate::common::{fails, json, with_scene};

/// q is a Brownian motion with drift: dq = ∂H₀/∂p dt + ∂H₁/∂p dW.
const WALK: &str = r#"[system]
state = ["q", "p"]
parameters = { mu = 0.3, sigma = 0.8 }
B = "canonical(q, p)"
H0 = "mu*p"
H = ["sigma*p"]
[run]
initial = [0, 0]
until = 2
steps = 32
scheme = "heun"
paths = 40000
"#;

const MU: f64 = 0.3;
const SIGMA: f64 = 0.8;
const T: f64 = 2.0;

/// The standard normal distribution function, by Simpson's rule.
fn normal(x: f64) -> f64 {
    let (from, n) = (-9.0, 2000);
    let h = (x - from) / f64::from(n);
    let density = |x: f64| (-0.5 * x * x).exp() / (2.0 * std::f64::consts::PI).sqrt();
    let weight = |k: i32| if k == 0 || k == n { 1.0 } else { f64::from(2 + 2 * (k % 2)) };
    (0..=n).map(|k| weight(k) * density(from + f64::from(k) * h)).sum::<f64>() * h / 3.0
}

/// P(q has been above 1 before t): the inverse Gaussian law.
fn passed_before(t: f64) -> f64 {
    let root = SIGMA * t.sqrt();
    normal((MU * t - 1.0) / root)
        + (2.0 * MU / (SIGMA * SIGMA)).exp() * normal((-1.0 - MU * t) / root)
}

fn at_end(scene: &str, seed: &str) -> Value {
    let folder = with_scene(scene);
    json(folder.path(), &["run", "scene.toml", "--json", "--seed", seed])["at_end"].clone()
}

/// How many standard errors a mean is from its truth.
fn deviations(point: &Value, truth: f64) -> f64 {
    let number = |key: &str| point[key].as_f64().expect("a number");
    (number("mean") - truth) / (number("deviation") / number("count").sqrt())
}

/// Within 4.5 standard errors, 7e-6 by chance.
#[track_caller]
fn holds(point: &Value, truth: f64) {
    let distance = deviations(point, truth);
    assert!(distance.abs() < 4.5, "{distance} standard errors from {truth}: {point}");
}

/// In two steps: given the ends of a step, its law within is exact.
#[test]
fn first_passages_of_brownian_motion_have_the_inverse_gaussian_law() {
    let events = "[events]\nhit = \"q > 1\"\neither = \"q > 1 or q > 2\"\n[observe]\nfar = \"q\"\n";
    let found = at_end(&format!("{}{events}", WALK.replace("steps = 32", "steps = 2")), "1");
    holds(&found["hit"], passed_before(T));
    // Of two conditions the first that comes true counts.
    holds(&found["either"], passed_before(T));
    // E min(T₁, t) = ∫(1 − P) dt, by the middles of many intervals.
    let mean: f64 = (0..4000)
        .map(|k| (1.0 - passed_before((f64::from(k) + 0.5) * T / 4000.0)) * T / 4000.0)
        .sum();
    holds(&found["hit time"], mean);
    let quantiles = found["hit time"]["quantiles"].as_array().unwrap();
    for quantile in &quantiles[..2] {
        let number = |key: &str| quantile[key].as_f64().expect("a number");
        let (level, found) = (number("level"), passed_before(number("value")));
        // And what straight lines in the bins of the histogram leave.
        let slack = 4.5 * (level * (1.0 - level) / 4e4).sqrt() + 1e-3;
        assert!((found - level).abs() < slack, "{found} for {level}");
    }
    let [lo, hi] = [0, 1].map(|end| found["hit"]["mean_interval"][end].as_f64().unwrap());
    let half = 1.96 * (passed_before(T) * (1.0 - passed_before(T)) / 4e4).sqrt();
    assert!((0.5 * (hi - lo) / half - 1.0).abs() < 0.02, "{lo} {hi} {half}");
}

/// The wrong method: an observable hides from the event what the noise does to it.
#[test]
fn passages_that_are_seen_at_the_ends_of_steps_are_too_few() {
    let events = "[observe]\nfar = \"q\"\n[events]\nhit = \"far > 1\"\n";
    let distance = deviations(&at_end(&format!("{WALK}{events}"), "1")["hit"], passed_before(T));
    assert!(distance < -9.0, "{distance}");
}

/// What is lacking for that is a√τ − bτ (Broadie, Glasserman and Kou 1997), of which half the step
/// shows (1 − 2^{−½})a√τ − bτ/2.
#[test]
fn the_step_error_of_such_a_passage_has_order_one_half() {
    let events = "[observe]\nfar = \"q\"\n[events]\nhit = \"far > 1\"\n";
    let scene = format!("{WALK}{events}").replace("steps = 32", "steps = 8");
    let folder = with_scene(&scene.replace("= 40000", "= 300000"));
    let (mut lacking, mut stated, mut variance) = (0.0, 0.0, 0.0);
    for seed in ["1", "2", "3"] {
        let found = json(folder.path(), &["run", "scene.toml", "--json", "--seed", seed]);
        let (point, paths) = (&found["at_end"]["hit"], found["step_check"]["paths"].as_f64());
        let size = point["step_error"]["mean"]["size"].as_f64().unwrap() / 3.0;
        lacking += (passed_before(T) - point["mean"].as_f64().unwrap()) / 3.0;
        stated += size;
        // Of n paths n·size/3.42 pass in half steps alone, with the variance of a count: times
        // 3.42²/n² this is 3.42·size/n.
        variance += 3.42 * size / paths.unwrap() / 3.0;
    }
    // 0.127 and 0.096 of 4 and 8 steps make bτ 0.16 of what is lacking, of which 0.71 are missed.
    let slack = 4.5 * variance.sqrt() + 0.12 * lacking;
    assert!((stated - lacking).abs() < slack, "{stated}, {lacking} ± {slack}");
}

#[test]
fn integrals_and_averages_of_brownian_motion() {
    let observe = "[observe]\narea = \"integral(q)\"\nmean = \"average( (q - mu)*q )\"\n\
                   square = \"area^2\"\n";
    let found = at_end(&format!("{WALK}{observe}"), "2");
    let (tau, s2) = (T / 32.0, SIGMA * SIGMA);
    holds(&found["area"], MU * T * T / 2.0);
    // ∫∫ min(s, t), by the trapezoidal rule: T³/3 + Tτ²/6.
    let variance = s2 * (T.powi(3) / 3.0 + T * tau * tau / 6.0);
    holds(&found["square"], variance + (MU * T * T / 2.0).powi(2));
    // The trapezoidal rule for t² has the error τ²/6.
    let of_square = s2 * T / 2.0 + MU * MU * (T * T / 3.0 + tau * tau / 6.0);
    holds(&found["mean"], of_square - MU * MU * T / 2.0);
}

#[test]
fn a_path_stays_where_it_stops() {
    // The second is seen at the ends of steps only, and stops there.
    for (event, step) in [("q > 1", SIGMA * (T / 32.0f64).sqrt()), ("far > 1", MU * T / 32.0)] {
        let hit = format!("hit = {{ when = \"{event}\", stop = true }}\n");
        let found = at_end(&format!("{WALK}[observe]\nfar = \"q\"\n[events]\n{hit}"), "3");
        // Wald: E q(T₁ ∧ T) = μ E(T₁ ∧ T), but for the step in which it stops; the deviation of
        // q − μ(T₁ ∧ T) is σ times the root of that time.
        let (q, time) = (&found["q"], found["hit time"]["mean"].as_f64().unwrap());
        let slack = 4.5 * SIGMA * time.sqrt() / 200.0 + step;
        assert!((q["mean"].as_f64().unwrap() - MU * time).abs() < slack, "{q} {time}");
        assert!(q["quantiles"][4]["value"].as_f64().unwrap() < 2.0, "{q}");
    }
}

#[test]
fn events_must_be_conditions() {
    for (event, words) in [
        ("\"q\"", "a probability is that of a condition"),
        ("{ when = \"q > r\" }", "unknown name `r`"),
        ("{ stop = true }", "missing key `when`"),
        ("{ when = \"q > 1\", stops = true }", "unknown key `stops`"),
        ("3", "a probability is that of a condition"),
    ] {
        let folder = with_scene(&format!("{WALK}[events]\nhit = {event}\n"));
        fails(folder.path(), &["run", "scene.toml"], 2, &[words]);
        assert!(!folder.path().join("scene-run").exists());
    }
}

/// What paths collect is in the coefficients that steps are compared with.
#[test]
fn orders_of_what_paths_collect() {
    let more = "[observe]\nwork = \"integral(q)\"\nlate = \"q*t\"\n\
                [events]\nhit = { when = \"q > 1\", stop = true }\n\
                [expect]\nof = [\"work\", \"late\", \"hit\"]\naccuracy = 0.01\n";
    let folder = with_scene(&format!("{WALK}{more}[damping]\nrate = \"0.5\"\n"));
    let command = ["order", "scene.toml", "--json", "--path-steps", "1e6"];
    let found = json(folder.path(), &command);
    for weak in found["weak"].as_array().unwrap() {
        let words = weak["words"].as_str().unwrap();
        assert!(words.contains("right in one step"), "{weak}");
    }
    let names: Vec<&Value> =
        found["weak"].as_array().unwrap().iter().map(|weak| &weak["quantity"]).collect();
    assert_eq!(names, ["E[work]", "E[late]", "E[hit]"]);
    assert_eq!(found["warnings"], serde_json::json!([]));
}

/// Averages and exponents are those of the state, whatever else a scene observes.
#[test]
fn chains_have_no_need_of_what_paths_collect() {
    let scene = r#"[system]
state = ["q", "p"]
B = "canonical"
H0 = "(p^2 + q^2)/2"
[bath]
friction = { p = 1 }
temperature = 1
[run]
initial = [0, 0]
until = 5
steps = 50
[observe]
work = "integral(q)"
square = "q^2"
[events]
far = "q > 3"
[expect]
of = ["square"]
accuracy = 0.3
"#;
    let folder = with_scene(scene);
    let square = json(folder.path(), &["equilibrium", "scene.toml", "--json"]);
    let [lo, hi] = ["lo", "hi"].map(|end| square["estimates"][0][end].as_f64().unwrap());
    assert!(lo < 1.0 && 1.0 < hi, "{square}");
    let exponent = ["lyapunov", "scene.toml", "--json", "--accuracy", "0.3"];
    let found = json(folder.path(), &exponent)["estimates"][0]["value"].as_f64().unwrap();
    assert!((found + 0.5).abs() < 0.3, "{found}");
    let folder = with_scene(&scene.replace("[\"square\"]", "[\"square\", \"work + q\"]"));
    let words = ["functions of the state alone: leave out `work + q`"];
    fails(folder.path(), &["equilibrium", "scene.toml"], 2, &words);
}
