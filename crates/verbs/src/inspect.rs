//! Inspection of a system.

use casimir::inspect::{InspectSettings, facts::Bath};

use serde_json::json;

use super::{Found, Watch};
use crate::failure::Done;
use scenes::{Scene, digits, model::with_names};

/// Inspects the system of a scene, whose scheme is not asked for.
pub fn inspect(scene: &Scene, watch: &Watch) -> Done<Found> {
    let model = &scene.model;
    let (problem, system) = (model.problem(), model.system());
    let (known, bath, findings) = watch.under("looking at points", 0, |_| {
        let settings = InspectSettings {
            run: Some(model.recommended()),
            y0: Some(problem.y0.clone()),
            damping: Some((problem.damping, problem.t_end)),
            friction: model.friction(),
            areas: system.description().jacobi_holds,
        };
        (model.known(), model.bath(), casimir::inspect::inspect(system, &settings))
    });
    let findings = findings.map_err(|error| scene.source.error(None, error))?;
    let text = format!("{findings}\n{}", bath.as_ref().map_or(String::new(), words));
    let text = with_names(&text, &scene.components);
    let text = format!("{}{}\n", known.equation(), text.trim_end());
    let mistakes = findings.mistakes.clone();
    let mut json = json!(findings);
    json["bath"] = json!(bath);
    Ok(Found::new(mistakes, text, json, Vec::new()))
}

/// Describes the stationary law in words.
fn words(Bath { beta, any, mismatch }: &Bath) -> String {
    match beta {
        _ if *any => "Without damping and heat: every function of H0 is stationary".into(),
        Some(beta) => {
            let kt = digits(1.0 / beta);
            format!("Heat bath: exp(-H0/kT) is stationary with kT = {kt}, if it has an integral")
        }
        None => format!("No heat bath:\n  - {}", mismatch.join("\n  - ")),
    }
}
