//! Statistics that `run` states, of W by dq = dW.

use crate::common::{read_json, succeeds, with_scene};

/// What is printed, and the statistics of the first observable at the end.
fn at_end(amplitude: &str, observe: &str) -> (String, serde_json::Value) {
    let folder = with_scene(&format!(
        r#"[system]
state = ["q", "p"]
B = [["0", "1"], ["-1", "0"]]
H0 = "0"
H = ["{amplitude}*p"]
[run]
initial = [0, 1]
until = 1
steps = 16
times = 1
paths = 100
scheme = "heun"
[observe]
gain = "{observe}"
"#
    ));
    let text = succeeds(folder.path(), &["run", "scene.toml", "--write", "json"]);
    let json = read_json(folder.path().join("scene-run/study.json"));
    let mut series = json["series"].as_array().unwrap().iter();
    let series = series.find(|series| series["observable"] == "gain").unwrap();
    (text, series["points"].as_array().unwrap().last().unwrap().clone())
}

#[test]
fn no_event_is_not_a_probability_of_zero() {
    let (text, event) = at_end("1", "min(1, max(0, 1e9*(q - 4)))");
    assert_eq!((event["mean"].as_f64(), event["mean_interval"].as_array()), (Some(0.0), None));
    let row = text.lines().find(|line| line.starts_with("gain")).unwrap();
    assert!(row.contains("all equal; others < 1 path in 33"), "{row}");
}

#[test]
fn tiny_states_have_a_deviation() {
    let (text, q) = at_end("1e-200", "q");
    // 1 ± 4.5/√200.
    let deviation = q["deviation"].as_f64().unwrap();
    assert!((deviation / 1e-200 - 1.0).abs() < 0.32, "{deviation}");
    let (lo, hi) = (q["mean_interval"][0].as_f64().unwrap(), q["mean_interval"][1].as_f64());
    assert!(lo < 0.0 && hi.unwrap() > 0.0 && q["variance"].is_null(), "{text}");
}
