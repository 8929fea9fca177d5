//! Expectations as text and as JSON.

use std::path::Path;

use casimir::{
    mc::expect::{Estimate, Level, WarningKind},
    plot::files,
};
use serde_json::{Value, json};

use crate::{commands::Expected, failure::Done, scene::Scene};

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
    let finite = |x: f64| x.is_finite().then_some(x);
    let estimate = |estimate: &Estimate| {
        let (lo, hi) = estimate.interval();
        json!({
            "of": estimate.name, "value": estimate.value, "lo": lo, "hi": hi,
            "half_width": estimate.half_width(), "standard_error": estimate.standard_error,
            "quantile": estimate.quantile, "bias_bound": estimate.bias_bound, "missed": estimate.missed,
            "judged": {
                "variance": estimate.judged.variance, "bias": estimate.judged.bias,
                "resolution": estimate.judged.resolution,
            },
            "failed_paths": estimate.failed,
        })
    };
    let level = |level: &Level| {
        let variances: Vec<_> = level.variances.iter().map(|&variance| finite(variance)).collect();
        json!({
            "level": level.level, "tau": level.tau, "samples": level.samples,
            "failed": level.failed, "path_steps_each": level.cost_per_path,
            "variances": variances,
        })
    };
    let warnings: Vec<String> = expectation.warnings.iter().map(ToString::to_string).collect();
    json!({
        "title": scene.title, "scheme": expectation.scheme, "because": because,
        "accuracy": expectation.accuracy, "reached": expectation.reached(),
        "estimates": expectation.estimates.iter().map(estimate).collect::<Vec<_>>(),
        "levels": expectation.levels.iter().map(level).collect::<Vec<_>>(),
        "path_steps": expectation.cost, "warnings": warnings, "seconds": seconds,
    })
}

/// Writes `expectation.json` and `expectation.txt`.
pub fn write_expectation(scene: &Scene, results: &Expected, folder: &Path) -> Done {
    files::write_json(&folder.join("expectation.json"), &expectation_json(scene, results))?;
    Ok(files::write(&folder.join("expectation.txt"), expectation_text(scene, results))?)
}
