//! `casimir inspect`: what a system is.

use casimir::analysis::{self, InspectSettings};

use super::{open, print, print_json, under_bar};
use crate::{
    arguments::Inspect,
    failure::Done,
    model::with_names,
    scene::{Changes, SchemeAndSeed},
};

/// Prints the findings. The scheme of the scene is not asked for.
pub fn inspect(arguments: &Inspect) -> Done {
    let scheme = SchemeAndSeed { sets: arguments.sets.clone(), ..SchemeAndSeed::default() };
    let scene = open(&arguments.scene, &Changes::from(&scheme))?;
    let model = &scene.model;
    let (problem, system) = (model.problem(), model.system());
    let settings = InspectSettings {
        y0: Some(problem.y0),
        damping: Some((problem.damping, problem.t_end)),
        areas: system.description().jacobi_holds,
    };
    let what = "looking at points";
    let (known, findings) =
        under_bar(what, 0, |_| (model.known(), analysis::inspect(system, &settings)));
    let findings = findings.map_err(|error| scene.source.error(None, error))?;
    if arguments.json {
        return print_json(&findings);
    }
    let text = with_names(&findings.to_string(), &scene.components);
    print(&format!("{}{}\n", known.equation(), text.trim_end()))
}
