//! What a system is.

use casimir::analysis::{self, InspectSettings};

use super::{Found, Watch};
use crate::{failure::Done, model::with_names, scene::Scene};

/// Inspects the system of a scene, whose scheme is not asked for.
pub fn inspect(scene: &Scene, watch: &Watch) -> Done<Found> {
    let model = &scene.model;
    let (problem, system) = (model.problem(), model.system());
    let settings = InspectSettings {
        y0: Some(problem.y0),
        damping: Some((problem.damping, problem.t_end)),
        areas: system.description().jacobi_holds,
    };
    let (known, findings) = watch.under("looking at points".into(), 0, || {
        (model.known(), analysis::inspect(system, &settings))
    });
    let findings = findings.map_err(|error| scene.source.error(None, error))?;
    let text = with_names(&findings.to_string(), &scene.components);
    let text = format!("{}{}\n", known.equation(), text.trim_end());
    Ok(Found { text, json: serde_json::to_value(&findings)?, figures: Vec::new() })
}
