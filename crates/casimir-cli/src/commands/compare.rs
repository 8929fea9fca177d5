//! `casimir compare`: which scheme is cheapest for an error.

use casimir::{
    report::{Bars, comparison_csv, figure::comparison, files},
    verify::{DynCompareSettings, Progress},
};

use super::{folder, open, print, print_json, threads};
use crate::{
    arguments::Compare,
    failure::{Done, Failure},
    model::with_model,
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
    let settings = &scene.settings;
    let wanted = DynCompareSettings {
        budget_s: arguments.budget,
        ..DynCompareSettings::new(error, settings.truncation, settings.key)
    };
    let bars = Bars::default();
    bars.begin(&format!("errors and times of all schemes, {} s at most", arguments.budget), 0);
    let found = with_model!(&scene.model, model => model.compare(&wanted));
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
    print(&format!("{found}\nfigure: {}\n", folder.join("compare.svg").display()))
}
