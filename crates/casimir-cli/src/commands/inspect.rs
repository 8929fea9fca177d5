//! `casimir inspect`: what a system is.

use super::{open, print, print_json, saying};
use crate::{arguments::Inspect, failure::Done, scene::Changes};

/// Prints the findings. The scheme of the scene is not asked for.
pub fn inspect(arguments: &Inspect) -> Done {
    let scene = open(&arguments.scene, &Changes::default())?;
    let what = "evaluating B and the Hamiltonians at many points";
    let (known, findings) = saying(what, || (scene.model.known(), scene.model.findings()));
    let findings = findings.map_err(|error| scene.source.error_of_all(error))?;
    if arguments.json {
        return print_json(&findings.json()?);
    }
    let text = findings.text(&scene.components);
    print(&format!("{}{}\n", known.equation(), text.trim_end()))
}
