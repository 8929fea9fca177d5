//! The program behind `cargo xtask work-precision` as a user meets it.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn work_precision(out: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_work-precision"))
        .args(["--quick", "--out"])
        .arg(out)
        .args(arguments)
        .output()
        .expect("the program of this crate runs")
}

fn measured(out: &Path) -> Value {
    let text = fs::read_to_string(out.join("work-precision.json"))
        .expect("a successful run writes its numbers");
    serde_json::from_str(&text).expect("work-precision.json is JSON")
}

/// Everything that does not depend on the machine.
fn errors(mut value: Value) -> Value {
    fn strip(value: &mut Value) {
        match value {
            Value::Object(fields) => {
                for name in ["time", "costs", "provenance"] {
                    fields.remove(name);
                }
                fields.values_mut().for_each(strip);
            }
            Value::Array(items) => items.iter_mut().for_each(strip),
            _ => {}
        }
    }
    strip(&mut value);
    value
}

#[test]
fn all_cases_have_numbers_figures_and_words() {
    let dir = tempfile::tempdir().unwrap();
    let page = dir.path().join("docs/page.md");
    let output = work_precision(dir.path(), &["--page", page.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let measured = measured(dir.path());
    assert_eq!(
        (measured["schema"].as_u64(), measured["provenance"]["mode"].as_str()),
        (Some(2), Some("quick"))
    );
    let cases = measured["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 6);
    let text = fs::read_to_string(dir.path().join("work-precision.md")).unwrap();
    assert_eq!(text, fs::read_to_string(&page).unwrap());
    assert!(!text.contains("NaN") && text.contains("Are Lévy areas worth their price?"));
    assert!(text.contains("The cheapest conformal scheme in multiples of `heun`"));
    for case in cases {
        let id = case["id"].as_str().unwrap();
        for kind in ["strong", "weak"] {
            let name = format!("figures/work-precision-{id}-{kind}.svg");
            let figure = fs::read_to_string(dir.path().join(&name)).unwrap();
            assert!(figure.starts_with("<svg") && text.contains(&name), "{name}");
            assert!(page.parent().unwrap().join(&name).is_file(), "{name}");
        }
        let series = case["strong"]["series"].as_array().unwrap();
        let schemes: Vec<&str> =
            series.iter().map(|series| series["scheme"].as_str().unwrap()).collect();
        let levy: &[&str] = if id == "rigid-body-3" { &["sexp-levy", "sexp-li-levy"] } else { &[] };
        let by_parts: &[&str] = if id == "lotka-volterra" { &[] } else { &["split", "nv"] };
        let all = [&["sexp"], levy, &["sexp-li"], by_parts, &["midpoint", "heun", "em"]].concat();
        assert_eq!(schemes, all, "{id}");
        for series in series {
            for point in series["points"].as_array().unwrap() {
                let (least, median) =
                    (point["time"]["min_s"].as_f64(), point["time"]["median_s"].as_f64());
                assert!(
                    point["error"].as_f64().unwrap() > 0.0
                        && least.unwrap() > 0.0
                        && least <= median,
                    "{id} {point}"
                );
                let scheme = series["scheme"].as_str().unwrap();
                for (index, defect) in point["defects"].as_array().unwrap().iter().enumerate() {
                    // Quadratic and linear Casimirs; the homogeneous energy of the one system that
                    // has one is kept by `sexp` alone.
                    let keeps = match scheme {
                        "sexp" | "sexp-levy" => true,
                        "sexp-li" | "sexp-li-levy" | "split" | "nv" => {
                            id != "lotka-volterra" || index > 0
                        }
                        _ => false,
                    };
                    let kept = defect.as_f64().unwrap() < 1e-12;
                    assert!(kept == keeps || id == "poisson3", "{id} {scheme} {point}");
                }
                let reads_areas = ["sexp-levy", "sexp-li-levy"].contains(&scheme);
                assert_eq!(point["area_terms"].is_u64(), reads_areas);
            }
        }
    }
}

#[test]
fn errors_are_the_same_bits_and_follow_the_seed() {
    let dir = tempfile::tempdir().unwrap();
    let run = |name: &str, arguments: &[&str]| {
        let out = dir.path().join(name);
        let arguments = [&["--only", "rigid-body-3"], arguments].concat();
        assert!(work_precision(&out, &arguments).status.success());
        errors(measured(&out))
    };
    let reference = run("one", &[]);
    assert_eq!(reference["cases"].as_array().unwrap().len(), 1);
    assert_eq!(reference, run("again", &[]));
    assert_ne!(reference, run("other", &["--seed", "2"]));
}

#[test]
fn bad_requests_are_refused_in_words_before_anything_is_written() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("out");
    let output = work_precision(&out, &["--only", "rigid-body"]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2));
    for word in ["'rigid-body'", "rigid-body-3", "maxwell-bloch"] {
        assert!(message.contains(word), "{message}");
    }
    assert!(!out.exists());

    let file = dir.path().join("a-file");
    fs::write(&file, "not a folder").unwrap();
    let output = work_precision(&file.join("below"), &[]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && message.contains("a-file"), "{message}");

    let output = work_precision(&out, &["--page", dir.path().to_str().unwrap()]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && message.contains("is a folder"), "{message}");
}
