//! Expectations as text and as JSON.

use casimir::mc::expect::{Estimate, WarningKind};
use serde_json::{Value, json};

use crate::{commands::Expected, scene::Scene};

/// The expectations in words.
pub fn expectation_text(scene: &Scene, results: &Expected) -> String {
    let Expected { because, expectation, seconds } = results;
    let mut text = expectation.to_string();
    text = text.replace("coarsest steps, or a higher finest level", "--steps");
    for warning in &expectation.warnings {
        if let WarningKind::Component(component) = warning.kind {
            let name = &scene.components[component - 1];
            text = text.replace(&format!("resolve y{component}:"), &format!("resolve {name}:"));
        }
    }
    if let Some(because) = because {
        text += &format!("{}: {because}\n", expectation.scheme);
    }
    text + &format!("{seconds:.2} s\n")
}

/// The expectations for programs.
pub fn expectation_json(scene: &Scene, results: &Expected) -> Value {
    let Expected { because, expectation, seconds } = results;
    let estimate = |estimate: &Estimate| {
        let (mut json, (lo, hi)) = (json!(estimate), estimate.interval());
        json["lo"] = lo.into();
        json["hi"] = hi.into();
        json["half_width"] = estimate.half_width().into();
        json
    };
    let warnings: Vec<String> = expectation.warnings.iter().map(ToString::to_string).collect();
    json!({
        "title": scene.title, "scheme": expectation.scheme, "because": because,
        "accuracy": expectation.accuracy, "reached": expectation.reached(),
        "estimates": expectation.estimates.iter().map(estimate).collect::<Vec<_>>(),
        "levels": expectation.levels,
        "path_steps": expectation.cost, "warnings": warnings, "seconds": seconds,
    })
}
