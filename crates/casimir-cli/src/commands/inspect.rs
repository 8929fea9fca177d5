//! `casimir inspect`: what a system is.

use super::{findings, open, print, print_json};
use crate::{arguments::Inspect, failure::Done, model::with_model, scene::Changes};

/// Prints the findings. The scheme of the scene is not asked for.
pub fn inspect(arguments: &Inspect) -> Done {
    let scene = open(&arguments.scene, &Changes::default())?;
    let findings = with_model!(&scene.model, model => findings(&scene, model)?);
    match arguments.json {
        true => print_json(&findings.json()?),
        false => print(&format!("{}\n", findings.text(&scene.components).trim_end())),
    }
}
