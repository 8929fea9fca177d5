//! `casimir compare`: which scheme is cheapest for an error.

use std::time::Instant;

use casimir::{
    analysis::CompareSettings,
    plot::{Bars, Progress, comparison_csv, figure::comparison, files},
};

use super::{folder, open, print, print_json, threads};
use crate::{
    arguments::Compare,
    failure::{Done, Failure},
    scene::{Changes, SchemeAndSeed},
};

/// Compares all schemes on a scene.
pub fn compare(arguments: &Compare) -> Done {
    let error = arguments.error;
    if !(arguments.budget > 0.0 && arguments.budget.is_finite()) {
        let message = format!("the budget must be positive and finite, got {} s", arguments.budget);
        return Err(Failure::Usage(message));
    }
    if !(error > 0.0 && error.is_finite()) {
        let message = format!("the wanted error must be positive and finite, got {error}");
        return Err(Failure::Usage(message));
    }
    let seed = SchemeAndSeed { scheme: None, seed: arguments.seed };
    let scene = open(&arguments.scene, &Changes::from(&seed))?;
    threads(arguments.output.threads)?;
    let (settings, start) = (&scene.settings, Instant::now());
    // What a run takes, for other reasons.
    let (auto, because) = scene.model.recommended();
    let spent = start.elapsed().as_secs_f64();
    let wanted = CompareSettings {
        budget_s: (arguments.budget - spent).max(0.5 * arguments.budget),
        ..CompareSettings::new(error, settings.truncation, settings.key)
    };
    let bars = Bars::default();
    bars.begin(&format!("errors and times of all schemes, {} s at most", arguments.budget), 0);
    let found = scene.model.compare(&wanted);
    bars.finish();
    let found = found.map_err(|error| scene.source.error_of_all(error))?;
    let folder = folder::of(arguments.output.out.as_ref(), &arguments.scene, "compare");
    folder::prepare(&folder)?;
    files::write(&folder.join("compare.svg"), comparison(&found))?;
    files::write(&folder.join("compare.csv"), comparison_csv(&found))?;
    files::write_json(&folder.join("compare.json"), &found)?;
    if arguments.output.json {
        return print_json(&serde_json::to_value(&found)?);
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
