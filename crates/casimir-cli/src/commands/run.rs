//! `casimir run`: paths and their statistics.

use std::{path::Path, time::Instant};

use casimir::{
    analysis::{StepCheck, checked_paths, step_check},
    mc::{
        Observe, Setup, Simulation, Study, StudySettings, TimeSeries,
        parts::{Job, Share, Stop, remove},
        study::StudyResult,
    },
};

use super::{
    Settled, folder, open, print, print_json, scheme, threads, under_bar, until_stopped, warn,
};
use crate::{
    arguments::Run,
    failure::{Done, Failure},
    model::Known,
    output,
    scene::Scene,
};

/// What a run found.
pub struct Results {
    /// The scheme.
    pub scheme: String,
    /// Why, if it was left to the program.
    pub because: Option<String>,
    /// What the system is.
    pub known: Known,
    /// Tables of the first paths.
    pub tables: Vec<TimeSeries>,
    /// Statistics of all paths, if there are many.
    pub study: Option<StudyResult>,
    /// How large the step errors are.
    pub check: Option<StepCheck>,
    /// Seconds of the computation.
    pub seconds: f64,
}

/// Runs a scene and writes its results.
pub fn run(arguments: &Run) -> Done {
    let scene = open(&arguments.scene, &arguments.changes)?;
    threads(arguments.output.threads)?;
    check_size(&scene, arguments.large)?;
    // The scene is checked before the folder is made.
    let ready = Ready::new(&scene, scheme(&scene))?;
    let folder = folder::of(arguments.output.out.clone(), &arguments.scene, "run")?;
    let kept = scene.settings.is_study().then_some(&*folder);
    let (results, stopped) = until_stopped(kept, |job, stop| ready.compute(job, stop))?;
    if stopped && results.as_ref().is_some_and(|results| results.paths() == 0) {
        return Err(Failure::stopped("before the first path: nothing was computed"));
    }
    if let Some(results) = &results {
        output::write(&scene, results, &folder, &arguments.write)?;
        report(&scene, results, &folder, arguments.output.json)?;
    }
    if stopped {
        let folder = folder.display();
        let words = format!("{folder} has what is complete; the same command goes on from there");
        return Err(Failure::stopped(words));
    }
    if let Some(folder) = kept {
        remove(folder, Share::WHOLE)?;
    }
    match results.and_then(Results::all_failed) {
        Some(failure) => Err(Failure::run(format!(
            "all paths failed: take more steps, or another scheme; {failure}"
        ))),
        None => Ok(()),
    }
}

impl Results {
    /// Number of paths.
    pub fn paths(&self) -> u64 {
        self.study.as_ref().map_or(self.tables.len() as u64, |study| study.record.paths)
    }

    /// The first failure, if no path came to its end.
    fn all_failed(self) -> Option<String> {
        let failures = match self.study {
            Some(study) if study.losses.failed < study.record.paths => return None,
            Some(study) => study.losses.failures,
            None => self.tables.into_iter().map(|table| table.halted).collect::<Option<_>>()?,
        };
        failures.into_iter().next()
    }

    /// What a reader must know of single paths, of the steps and of the statistics.
    pub fn warnings(&self, scene: &Scene) -> Vec<String> {
        let Self { tables, study, check, .. } = self;
        let steps = check.iter().flat_map(|check| output::step_lines(check, study.as_ref(), scene));
        let warnings = study.iter().flat_map(|study| study.warnings.clone());
        let halted = tables.iter().enumerate().filter_map(|(path, table)| {
            table.halted.as_ref().map(|halted| format!("path {path}: {halted}"))
        });
        steps.chain(warnings).chain(halted).collect()
    }
}

/// A run that was checked.
pub struct Ready<'a> {
    scene: &'a Scene,
    scheme: String,
    setup: Setup<'a>,
    because: Option<String>,
}

impl<'a> Ready<'a> {
    /// Checks that the scheme can be run.
    pub fn new(scene: &'a Scene, (scheme, because): Settled) -> Done<Self> {
        let (setup, settings) = (scene.setup(&scheme)?, &scene.settings);
        if setup.scheme.clips_increments()
            && let Err(error) = settings.truncation.bound(settings.until / settings.steps as f64)
        {
            let least = settings.until.floor() as u64 + 1;
            let message = format!(
                "{} truncates increments: {error}. Take at least {least} steps, or leave out \
                 `truncation`",
                setup.scheme.id()
            );
            return Err(scene.steps_error(message).into());
        }
        Ok(Self { scene, scheme, setup, because })
    }

    /// Computes tables and statistics; none if another part has them.
    pub fn compute(self, job: &Job, stop: &Stop) -> Done<Option<Results>> {
        let start = Instant::now();
        let Self { scene, scheme, setup, because } = self;
        let Scene { components, observables, settings, model, .. } = scene;
        let (steps, truncation, key) = (settings.steps, settings.truncation, settings.key);
        let mut study = None;
        if settings.is_study() {
            let wanted = StudySettings::new(steps, settings.times, settings.paths, truncation, key);
            let of_all = Study::new(&setup, observables, &wanted);
            let of_all = of_all.map_err(|error| scene.steps_error(error))?;
            study = under_bar("paths", settings.paths * steps, |done| {
                of_all.run_in(job, "study", done)
            });
        }
        let checked = checked_paths(settings.paths, setup.problem.noises);
        let phi: Vec<&dyn Observe> = observables.iter().map(|phi| phi as _).collect();
        let check =
            step_check(&setup, &phi, steps, checked, model.fastest(), (truncation, key), job);
        let check = check.map_err(|error| scene.steps_error(error))?;
        if settings.is_study() && study.is_none() {
            return Ok(None);
        }
        let mut simulation = Simulation::new(model.with_laws(setup), truncation)
            .every(steps / settings.times)
            .with_components(components.clone())
            .stopped_by(stop);
        for observable in observables.iter().filter(|observable| !observable.is_component()) {
            simulation = simulation.observing(observable.clone());
        }
        let tables = simulation.paths(steps, key, 0..settings.tables);
        let tables = tables.map_err(|error| scene.steps_error(error))?;
        let (known, seconds) = (warn(scene), start.elapsed().as_secs_f64());
        Ok(Some(Results { scheme, because, known, tables, study, check, seconds }))
    }
}

/// Refuses to write gigabytes by mistake.
fn check_size(scene: &Scene, allowed: bool) -> Done {
    let (settings, columns) = (&scene.settings, scene.columns());
    let (tables, times) = (settings.tables, settings.times);
    // A number in a text takes 20 bytes.
    let gigabytes = 2e-8 * tables as f64 * (times + 1) as f64 * columns as f64;
    if gigabytes > 1.0 && !allowed {
        return Err(Failure::usage(format!(
            "{tables} tables of {times} times and {columns} columns are {gigabytes:.1} GB of text: \
             take fewer `tables` or `times`, or say --large"
        )));
    }
    Ok(())
}

/// Says what was computed and where it is.
pub fn report(scene: &Scene, results: &Results, folder: &Path, json: bool) -> Done {
    if json {
        return print_json(&output::summary(scene, results, folder)?);
    }
    let Results { scheme, because, study, check, seconds, .. } = results;
    let mut text: String =
        results.warnings(scene).iter().map(|warning| format!("warning: {warning}\n")).collect();
    let (paths, steps) = (results.paths(), scene.settings.steps);
    let word = if paths == 1 { "path" } else { "paths" };
    text += &format!("{paths} {word}, {steps} steps of {scheme}, {seconds:.2} s\n");
    if let Some(because) = because {
        text += &format!("{scheme}: {because}\n");
    }
    if let Some(study) = study {
        text += &output::table_at_end(study, check.as_ref());
    }
    text += &format!("report: {}\n", folder.join(folder::REPORT).display());
    print(&text)
}
