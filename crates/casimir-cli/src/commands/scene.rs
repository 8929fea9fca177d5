//! Commands on a scene: `casimir run`, and all verbs of one scene.

use std::fs;

use casimir::mc::{
    Checkpoint,
    parts::{JobError, remove},
};
use clap::Args;
use scenes::{Combination, Scene, Sweep};
use verbs::{
    self, Outcomes, Store, Stores, Verb, failure::Failure::Stopped, output::Format, program,
};

use super::*;
use crate::arguments::{Asked, Run};

/// Runs a scene, at every combination of what is varied, and writes the results.
pub fn run(Run { changes, write: formats, large, machine, on }: &Run) -> Done {
    let device = device(*machine)?;
    let sweep = read(on, |source| Sweep::new(&Source { device, ..source }, changes))?;
    if !(formats.is_empty() || *large) {
        check_size(&sweep)?;
    }
    // The scenes are checked before the folder is made.
    let ready = watch().under(READING, 0, |_| verbs::ready(&sweep, verbs::settle(&sweep)))?;
    let folder = folder(on, "run")?;
    prepare(&folder)?;
    let scene = sweep.scene();
    let keeps = scene.settings.is_study() || scene.model.large().is_some();
    let kept = keeps.then_some(&*folder);
    let watch = stoppable();
    let job = match kept {
        Some(folder) => keeping(folder, program(sweep.scene(), ""), &watch)?,
        None => Job::here().stopped_by(&watch.stop).giving_what_is_done(),
    };
    let results = verbs::compute(&sweep, ready, &job, &watch)?;
    let mut stopped = watch.stop.is_asked();
    let mut next = if keeps { "goes on from there" } else { "begins anew" };
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
        return Err(Stopped("before the first results: nothing is written".into()));
    }
    write(&results, &folder, formats, on.json)?;
    if stopped {
        return Err(Stopped(format!(
            "{} has what is complete; the same command {next}",
            folder.display()
        )));
    }
    if let Some(folder) = kept {
        remove(folder, Share::WHOLE)?;
    }
    results.check()
}

/// Says what was found, and writes it.
pub fn write(found: &Outcomes<'_>, folder: &Path, formats: &[Format], json: bool) -> Done {
    let file = folder.join(REPORT);
    // First, and whatever becomes of the files.
    let told = if json {
        let mut json = found.json();
        json["report"] = file.to_string_lossy().into();
        print_json(&json)
    } else {
        print(&found.text())
    };
    watch().under("writing the results", 0, |_| found.write(folder, formats))?;
    told?;
    if json { Ok(()) } else { print(&format!("report: {}\n", file.display())) }
}

/// Refuses to write gigabytes of text by mistake.
fn check_size(sweep: &Sweep) -> Done {
    let scene = sweep.scene();
    let columns = 1 + scene.components.len() + scene.observables.len();
    let rows = scene.settings.tables * sweep.combinations.len() as u64 * (scene.settings.times + 1);
    // A number takes 20 bytes.
    let gigabytes = 2e-8 * rows as f64 * columns as f64;
    if gigabytes > 1.0 {
        return refuse(format!(
            "{rows} rows of {columns} columns are {gigabytes:.1} GB of text: take fewer `tables` \
             or `times`, or say --large"
        ));
    }
    Ok(())
}

/// Computes a verb of a scene, at every combination of what is varied, and prints and writes what
/// was found: in a folder for each combination, and as a list in JSON.
pub fn compute<V: Verb + Args>(Asked { options, on }: &Asked<V>) -> Done {
    let changes = options.changes();
    if V::STORES == Stores::Nothing {
        let scene = read(on, |source| Scene::new(source, &changes))?;
        let found = options.compute(&scene, &Store::Nothing, &watch())?;
        return tell(&found, on.out.as_deref(), V::NAME, on.json);
    }
    let scenes = read(on, |source| Sweep::apart(&source, &changes))?;
    let whole = folder(on, V::NAME)?;
    if let [Combination { label, scene, .. }] = &scenes[..]
        && label.is_empty()
    {
        let to = if V::WRITES { Some(&*whole) } else { on.out.as_deref() };
        return one(options, scene, &whole, |found| tell(found, to, V::NAME, on.json));
    }
    let (mut unreached, mut list) = (Vec::new(), Vec::new());
    for (k, Combination { label, values, scene, .. }) in scenes.iter().enumerate() {
        let folder = whole.join(format!("combination-{}", k + 1));
        if !on.json {
            print(&format!("== {label}\n"))?;
        }
        let told = one(options, scene, &folder, |found| {
            if !on.json {
                return tell(found, Some(&folder), V::NAME, false);
            }
            let mut json = found.json.clone();
            // A fit has parameters of its own.
            let key = if json["parameters"].is_null() { "parameters" } else { "varied" };
            json[key] = values.iter().cloned().collect();
            list.push(json);
            store(found, &folder, V::NAME).map(drop)
        });
        match told {
            Err(Failure::Run(words)) => unreached.push(format!("{label}: {words}")),
            told => told?,
        }
    }
    if on.json {
        print_json(&list)?;
    }
    if unreached.is_empty() { Ok(()) } else { Err(Failure::Run(unreached.join("\n"))) }
}

/// Computes a verb of one scene, whose unfinished work is in a folder; `tell` prints and writes
/// what was found.
fn one<V: Verb>(
    options: &V,
    scene: &Scene,
    folder: &Path,
    tell: impl FnOnce(&Found) -> Done,
) -> Done {
    match V::STORES {
        Stores::Samples(file) => sampled(options, scene, &folder.join(file), tell),
        _ => measured(options, scene, folder, tell),
    }
}

/// Computes a verb whose measurements are stored in a folder until it is complete.
fn measured(
    options: &impl Verb,
    scene: &Scene,
    folder: &Path,
    tell: impl FnOnce(&Found) -> Done,
) -> Done {
    let watch = stoppable();
    let new: Vec<&Path> = folder.ancestors().take_while(|folder| !folder.exists()).collect();
    let job = Arc::new(keeping(folder, program(scene, &options.meaning()), &watch)?);
    let found = options.compute(scene, &Store::Measurements(&job), &watch);
    match Arc::into_inner(job).map_or(Ok(()), Job::finish) {
        Ok(()) | Err(JobError::Stopped) if watch.stop.is_asked() => {
            return Err(Stopped(format!(
                "{} has what was measured; the same command goes on",
                folder.display()
            )));
        }
        Err(error @ JobError::File { .. }) => eprintln!("warning: no checkpoint: {error}"),
        // Or the time is over.
        Ok(()) | Err(JobError::Stopped) => {}
        Err(error) => return Err(error.into()),
    }
    let told = found.and_then(|found| tell(&found));
    // With an answer, or with a wrong question, there is nothing to go on from.
    if !matches!(told, Err(Failure::Run(_) | Stopped(_))) {
        remove(folder, Share::WHOLE)?;
        new.iter().for_each(|folder| drop(fs::remove_dir(folder)));
    }
    told
}

/// Computes a verb whose samples are stored in a file. Whether it was stopped or its accuracy not
/// reached is the exit code.
fn sampled(
    options: &impl Verb,
    scene: &Scene,
    file: &Path,
    tell: impl FnOnce(&Found) -> Done,
) -> Done {
    let samples = Checkpoint::new(file, program(scene, &options.meaning()));
    let watch = stoppable();
    if samples.holds()? {
        going_on(file);
    }
    let found = options.compute(scene, &Store::Samples(&samples), &watch);
    let told = found.and_then(|found| tell(&found).map(|()| found.unreached));
    let file = file.display();
    if let Some(error) = samples.failure() {
        eprintln!("warning: the samples are not kept in {file}: {error}");
    }
    let next = || match samples.holds() {
        Ok(true) => format!("samples are in {file}: the same command goes on from them"),
        _ => "no samples are kept: the same command begins anew".into(),
    };
    match told {
        Err(Stopped(words)) => Err(Stopped(format!("{words}; {}", next()))),
        Ok(_) if watch.stop.is_asked() => Err(Stopped(next())),
        Ok(Some(words)) => Err(Failure::Run(words)),
        told => told.map(drop),
    }
}
