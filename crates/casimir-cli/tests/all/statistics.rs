//! Statistics that `run` states.

use serde_json::Value;

use crate::common::{read_json, succeeds, with_scene};

/// W by dq = dW, with the formulas of `observe`.
fn wiener(paths: u32, amplitude: &str, observe: &str) -> String {
    format!(
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
paths = {paths}
scheme = "heun"
[observe]
{observe}
"#
    )
}

/// What is printed, and the statistics at the end of this observable.
fn at_end(scene: &str, name: &str) -> (String, Value) {
    let folder = with_scene(scene);
    let text = succeeds(folder.path(), &["run", "scene.toml", "--write", "json"]);
    let json = read_json(folder.path().join("scene-run/study.json"));
    let series = json["series"].as_array().unwrap().iter();
    let series = series.clone().find(|series| series["observable"] == name).unwrap();
    (text, series["points"].as_array().unwrap().last().unwrap().clone())
}

#[test]
fn no_event_is_not_a_probability_of_zero() {
    let event = "event = \"min(1, max(0, 1e9*(q - 4)))\"";
    let (text, event) = at_end(&wiener(100, "1", event), "event");
    assert_eq!((event["mean"].as_f64(), event["mean_interval"].as_array()), (Some(0.0), None));
    let row = text.lines().find(|line| line.starts_with("event")).unwrap();
    assert!(row.contains("all equal; others < 1 path in 33"), "{row}");
}

#[test]
fn tiny_states_have_a_deviation() {
    let (text, q) = at_end(&wiener(1000, "1e-200", ""), "q");
    let deviation = q["deviation"].as_f64().unwrap();
    // 1 ± 4.5/√2000.
    assert!((deviation / 1e-200 - 1.0).abs() < 0.1, "{deviation}");
    let (lo, hi) = (q["mean_interval"][0].as_f64().unwrap(), q["mean_interval"][1].as_f64());
    assert!(lo < 0.0 && hi.unwrap() > 0.0 && q["variance"].is_null(), "{text}");
}

/// Of few paths and of many.
#[test]
fn quantiles_at_an_atom_are_the_atom() {
    for paths in [1800, 600_000] {
        let (text, gain) = at_end(&wiener(paths, "0.06", "gain = \"max(0, q - 0.1)\""), "gain");
        for quantile in &gain["quantiles"].as_array().unwrap()[..3] {
            assert_eq!(quantile["value"].as_f64(), Some(0.0), "{paths}: {text}");
            assert_eq!(quantile["hi"].as_f64(), Some(0.0), "{paths}");
        }
    }
}
