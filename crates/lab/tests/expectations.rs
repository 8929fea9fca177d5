//! The program behind `cargo xtask expectations` as a user meets it.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn expectations(out: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_expectations"))
        .args(["--quick", "--out"])
        .arg(out)
        .args(arguments)
        .output()
        .expect("the program of this crate runs")
}

#[test]
fn every_method_has_rows_and_every_scheme_a_bias() {
    let dir = tempfile::tempdir().unwrap();
    let page = dir.path().join("docs/page.md");
    let output = expectations(dir.path(), &["--page", page.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = fs::read_to_string(dir.path().join("expectations.json")).unwrap();
    let measured: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(
        (measured["schema"].as_u64(), measured["provenance"]["mode"].as_str()),
        (Some(1), Some("quick"))
    );

    let methods = measured["methods"].as_array().unwrap();
    let names: Vec<_> = methods.iter().map(|method| method["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["single paths", "multilevel", "quasi-Monte Carlo", "Expect"]);
    for method in methods {
        let rows = method["rows"].as_array().unwrap();
        assert!(!rows.is_empty());
        for row in rows {
            let [error, half] = ["error", "half_width"].map(|key| row[key].as_f64().unwrap());
            // A half-width of 95 %, and a seed that is fixed.
            assert!(error.abs() <= 2.0 * half && row["reached"] == true, "{row}");
            assert!(
                row["path_steps"].as_u64() > Some(0) && half <= row["accuracy"].as_f64().unwrap()
            );
        }
    }
    let twelve = measured["twelve"]["estimates"].as_array().unwrap();
    assert_eq!(twelve.len(), 12);

    let schemes = measured["bias"]["schemes"].as_array().unwrap();
    let size = |name: &str, steps: u64| {
        let scheme = schemes.iter().find(|scheme| scheme["scheme"] == name).unwrap();
        let points = scheme["functions"][1]["points"].as_array().unwrap();
        let point = points.iter().find(|point| point["steps"] == steps).unwrap();
        point["bias"].as_f64().unwrap().abs()
    };
    assert_eq!(schemes.len(), 8);
    // The bias of sexp-li for this function changes its sign near four steps.
    for other in ["em", "midpoint", "sexp", "split"] {
        assert!(size("nv", 4) < 0.5 * size(other, 4), "{other}");
    }

    let problems = measured["orders"]["problems"].as_array().unwrap();
    let names: Vec<_> =
        problems.iter().map(|problem| problem["problem"].as_str().unwrap()).collect();
    assert_eq!(names, ["rigid-body", "maxwell-bloch", "poisson3"]);
    let mut refuted = 0;
    for scheme in problems.iter().flat_map(|problem| problem["schemes"].as_array().unwrap()) {
        assert!(scheme["defect"].as_f64().unwrap() < 1e-12, "{}", scheme["scheme"]);
        let functions = scheme["functions"].as_array().unwrap();
        assert_eq!(functions.len(), 6);
        // Intervals of neighbours, which are narrower than those without the next term.
        let below_two =
            |function: &&Value| function["fine"]["hi"].as_f64().is_some_and(|hi| hi < 2.0);
        if scheme["twin"] == true {
            assert!(functions.iter().filter(below_two).count() >= 2, "{}", scheme["scheme"]);
            refuted += 1;
        }
    }
    assert_eq!(refuted, 4);

    let text = fs::read_to_string(dir.path().join("expectations.md")).unwrap();
    assert_eq!(text, fs::read_to_string(&page).unwrap());
    assert!(!text.contains("NaN") && text.contains("## Bias of schemes"));
    for name in ["expectations-path-steps.svg", "expectations-seconds.svg"] {
        let figure = page.parent().unwrap().join("figures").join(name);
        assert!(fs::read_to_string(figure).unwrap().starts_with("<svg") && text.contains(name));
    }
}

#[test]
fn a_page_that_cannot_be_written_is_refused_before_the_computing() {
    let dir = tempfile::tempdir().unwrap();
    let output = expectations(&dir.path().join("out"), &["--page", dir.path().to_str().unwrap()]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && message.contains("is a folder"), "{message}");
}
