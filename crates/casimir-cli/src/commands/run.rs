//! `casimir run`: paths and their statistics.

use std::path::Path;

use casimir::mc::parts::{Job, JobError, Share, remove};
use casimir_cli::{
    failure::{Done, Failure},
    output::{Format, Report},
    scene::{Combination, Sweep},
    verbs::{Outcomes, compute, ready, settle},
};

use super::{
    READING, REPORT, folder, keeping, prepare, print, print_json, program, source, stoppable,
    threads, watch,
};
use crate::arguments::Run;

/// Runs a scene, at every combination of what is varied, and writes the results.
pub fn run(Run { changes, write: formats, large, on }: &Run) -> Done {
    let source = source(&on.scene)?;
    let sweep = watch().under(READING.into(), 0, || Sweep::new(&source, changes))?;
    threads(on.threads)?;
    if !(formats.is_empty() || *large) {
        check_size(&sweep)?;
    }
    // The scenes are checked before the folder is made.
    let ready = watch().under(READING.into(), 0, || ready(&sweep, settle(&sweep)))?;
    let folder = folder(on, "run")?;
    prepare(&folder)?;
    let is_study = sweep.combinations[0].scene.settings.is_study();
    let kept = is_study.then_some(&*folder);
    let watch = stoppable();
    let job = match kept {
        Some(folder) => {
            let program = program(&sweep.combinations[0].scene, "");
            keeping(folder, program, &watch)?
        }
        None => Job::here().stopped_by(&watch.stop).giving_what_is_done(),
    };
    let results = compute(&sweep, ready, &job, &watch)?;
    let mut stopped = watch.stop.is_asked();
    let mut next = if is_study { "goes on from there" } else { "begins anew" };
    match job.finish() {
        // The results are here.
        Err(error @ JobError::File { .. }) => {
            eprintln!("warning: no checkpoint: {error}");
            next = "goes on from an older checkpoint, or begins anew";
        }
        Err(JobError::Stopped) => stopped = true,
        finished => finished?,
    }
    if stopped && results.are_empty() {
        return Err(Failure::Stopped("before the first results: nothing is written".into()));
    }
    write(&results, &folder, formats, on.json)?;
    if stopped {
        let folder = folder.display();
        let words = format!("{folder} has what is complete; the same command {next}");
        return Err(Failure::Stopped(words));
    }
    if let Some(folder) = kept {
        remove(folder, Share::WHOLE)?;
    }
    results.check()
}

/// Says what was found, and writes it.
pub fn write(found: &Outcomes<'_>, folder: &Path, formats: &[Format], json: bool) -> Done {
    let (found, file) = (Report::new(found), folder.join(REPORT));
    // First, and whatever becomes of the files.
    let told = if json {
        let mut json = found.json();
        json["report"] = file.to_string_lossy().into();
        print_json(&json)
    } else {
        print(&found.text())
    };
    watch().under("writing the results".into(), 0, || found.write(folder, formats))?;
    told?;
    if json { Ok(()) } else { print(&format!("report: {}\n", file.display())) }
}

/// Refuses to write gigabytes of text by mistake.
fn check_size(sweep: &Sweep) -> Done {
    let Combination { scene, .. } = &sweep.combinations[0];
    let columns = 1 + scene.components.len() + scene.observables.len();
    let rows = scene.settings.tables * sweep.combinations.len() as u64 * (scene.settings.times + 1);
    // A number takes 20 bytes.
    let gigabytes = 2e-8 * rows as f64 * columns as f64;
    if gigabytes > 1.0 {
        return Err(Failure::Usage(format!(
            "{rows} rows of {columns} columns are {gigabytes:.1} GB of text: take fewer `tables` \
             or `times`, or say --large"
        )));
    }
    Ok(())
}
