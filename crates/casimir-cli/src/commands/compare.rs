//! `casimir compare`: which scheme is cheapest for an error.

use std::{fmt::Display, time::Instant};

use casimir::{
    analysis::{self, CompareSettings},
    plot::{figure::comparison, files, under_words},
};

use super::{folder, open, print, print_json, threads};
use crate::{
    arguments::Compare,
    failure::Done,
    scene::{Changes, SchemeAndSeed},
};

/// Compares all schemes on a scene.
pub fn compare(arguments: &Compare) -> Done {
    let (error, budget) = (arguments.error, arguments.budget);
    let seed = SchemeAndSeed { scheme: None, seed: arguments.seed, sets: arguments.sets.clone() };
    let scene = open(&arguments.scene, &Changes::from(&seed))?;
    threads(arguments.output.threads)?;
    let (settings, start) = (&scene.settings, Instant::now());
    // What a run takes, for other reasons.
    let (auto, because) = scene.model.recommended();
    let spent = start.elapsed().as_secs_f64();
    let wanted = CompareSettings {
        budget_s: (budget - spent).max(0.5 * budget),
        ..CompareSettings::new(error, settings.truncation, settings.key)
    };
    let wrong = |error: &dyn Display| scene.source.error(None, error);
    let candidates = scene.model.candidates().map_err(|error| wrong(&error))?;
    let what = format!("errors and times of all schemes, {budget} s at most");
    let problem = scene.problem();
    let found = under_words(&what, |say| {
        let told = |least, left_s| {
            say(format!(
                "error {least:.1e} so far, {error:.1e} wanted, {left_s:.0} s left at most"
            ));
        };
        analysis::compare(&problem, &candidates, &wanted, &told)
    });
    let found = found.map_err(|error| wrong(&error))?;
    let folder = folder::of(arguments.output.out.clone(), &arguments.scene, "compare")?;
    files::write(&folder.join("compare.svg"), comparison(&found))?;
    files::write_json(&folder.join("compare.json"), &found)?;
    if arguments.output.json {
        return print_json(&found);
    }
    let rule = match found.recommended() {
        Some(scheme) if scheme == auto => format!("`casimir run` takes {auto}, too"),
        _ => format!(
            "`casimir run` takes {auto} by another rule, that of long times: {because}.\nHere the \
             processor time for this error at T = {}, on this machine, decides",
            settings.until
        ),
    };
    print(&format!("{found}\n{rule}.\nfigure: {}\n", folder.join("compare.svg").display()))
}
