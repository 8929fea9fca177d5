//! `casimir run`: paths and their statistics.

use std::{path::Path, time::Instant};

use casimir::{
    analysis::{StepCheck, checked_paths, step_check},
    mc::{
        Observe, Simulation, Study, StudySettings, TimeSeries,
        parts::{Job, JobError, Share, Stop, remove},
        study::StudyResult,
    },
    plot::{Bars, Progress},
};

use super::{
    Settled, exact_quantiles, folder, open, print, print_json, program, scheme, stop, stoppable,
    threads, warn,
};
use crate::{
    arguments::{Format, Run},
    failure::{Done, Failure},
    model::{Known, Model},
    output,
    scene::{Observable, Scene},
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
    let folder = folder::of(arguments.output.out.as_ref(), &arguments.scene, "run");
    check_size(&scene, &arguments.write, arguments.large)?;
    let stop = stop();
    // The scene is checked before the folder is made.
    let (results, stopped) = {
        let model = &*scene.model;
        let ready = Ready::new(&scene, model, None)?;
        folder::prepare(&folder)?;
        let job = match scene.settings.is_study() {
            true => Job::part(&folder, Share::WHOLE, program())?,
            false => Job::here(),
        };
        if job.resumes() {
            let file = folder.join(Share::WHOLE.file_name());
            eprintln!("going on from a checkpoint; to begin anew, delete {}", file.display());
        }
        let job = stoppable(job, &stop);
        let results = ready.compute(&job, &stop)?;
        let stopped = match job.finish() {
            Err(JobError::Stopped) => true,
            finished => {
                finished?;
                stop.is_asked()
            }
        };
        (results, stopped)
    };
    let none =
        |results: &Results| results.study.as_ref().is_some_and(|study| study.record.paths == 0);
    if stopped && results.as_ref().is_some_and(none) {
        return Err(Failure::Stopped("before the first path: nothing was computed".into()));
    }
    if let Some(results) = &results {
        output::write(&scene, results, &folder, &arguments.write)?;
        report(&scene, results, &folder, arguments.output.json)?;
    }
    if stopped {
        let folder = folder.display();
        let words = format!("{folder} has what is complete; the same command goes on from there");
        return Err(Failure::Stopped(words));
    }
    if scene.settings.is_study() {
        remove(&folder, Share::WHOLE)?;
    }
    match results.and_then(|results| results.all_failed()) {
        Some(failure) => Err(Failure::Run(anyhow::anyhow!(
            "all paths failed: take more steps, or another scheme; {failure}"
        ))),
        None => Ok(()),
    }
}

impl Results {
    /// The first failure, if no path came to its end.
    fn all_failed(self) -> Option<String> {
        match self.study {
            Some(study) => {
                let all = study.losses.failed >= study.record.paths;
                all.then(|| study.losses.failures.into_iter().next()).flatten()
            }
            None => {
                let failed: Option<Vec<String>> =
                    self.tables.into_iter().map(|table| table.halted).collect();
                failed.and_then(|failed| failed.into_iter().next())
            }
        }
    }
}

/// A run that was checked.
pub struct Ready<'a> {
    scene: &'a Scene,
    model: &'a dyn Model,
    scheme: String,
    because: Option<String>,
}

impl<'a> Ready<'a> {
    /// Chooses the scheme unless it is settled, and checks that it can be run.
    pub fn new(scene: &'a Scene, model: &'a dyn Model, settled: Option<&Settled>) -> Done<Self> {
        let (scheme, because) = settled.cloned().unwrap_or_else(|| self::scheme(scene, model));
        let (source, settings) = (&scene.source, &scene.settings);
        let setup = model.setup(&scheme);
        let setup = setup.map_err(|error| settings.scheme_error(source, error))?;
        settings.check_steps(source, &setup)?;
        Ok(Self { scene, model, scheme, because })
    }

    /// Computes tables and statistics; none if another part has them.
    pub fn compute(self, job: &Job, stop: &Stop) -> Done<Option<Results>> {
        let start = Instant::now();
        let settings = &self.scene.settings;
        let is_study = settings.is_study();
        let study = if is_study { self.study(job)? } else { None };
        let check = self.check(job)?;
        if is_study && study.is_none() {
            return Ok(None);
        }
        let known = warn(self.model);
        let mut study = study;
        let exact = study.as_mut().filter(|study| study.record.paths == settings.paths);
        let exact = exact.filter(|_| exact_quantiles::are_affordable(self.scene));
        let all = if exact.is_some() { settings.paths } else { settings.tables };
        let mut tables = self.tables(all, stop)?;
        if let Some(study) = exact.filter(|_| !stop.is_asked()) {
            exact_quantiles::replace(study, &tables);
        }
        tables.truncate(settings.tables as usize);
        let Self { scheme, because, .. } = self;
        let seconds = start.elapsed().as_secs_f64();
        Ok(Some(Results { scheme, because, known, tables, study, check, seconds }))
    }

    fn setup(&self) -> Done<casimir::mc::Setup<'_>> {
        let Self { scene, model, scheme, .. } = self;
        let setup = model.setup(scheme);
        Ok(setup.map_err(|error| scene.settings.scheme_error(&scene.source, error))?)
    }

    /// The step errors of what is shown, as a piece of work of a job.
    fn check(&self, job: &Job) -> Done<Option<StepCheck>> {
        let Scene { source, observables, settings, .. } = self.scene;
        let setup = self.setup()?;
        let paths = checked_paths(settings.paths, setup.problem.noises);
        let observables: Vec<&dyn Observe> =
            observables.iter().map(|observable: &Observable| observable as _).collect();
        let noise = (settings.truncation, settings.key);
        let (steps, fastest) = (settings.steps, self.model.fastest());
        let check = step_check(&setup, &observables, steps, paths, fastest, noise, job);
        Ok(check.map_err(|error| settings.steps_error(source, error))?)
    }

    /// The tables of the first paths.
    fn tables(&self, paths: u64, stop: &Stop) -> Done<Vec<TimeSeries>> {
        let Scene { source, components, observables, settings, .. } = self.scene;
        let setup = self.model.with_laws(self.setup()?);
        let mut simulation = Simulation::new(setup, settings.truncation)
            .every(settings.steps / settings.times)
            .with_components(components.clone())
            .stopped_by(stop);
        for observable in observables.iter().filter(|observable| !observable.is_component()) {
            simulation = simulation.observing(observable.clone());
        }
        let tables = simulation.paths(settings.steps, settings.key, 0..paths);
        Ok(tables.map_err(|error| settings.steps_error(source, error))?)
    }

    /// Statistics of all paths, as a piece of work of a job.
    fn study(&self, job: &Job) -> Done<Option<StudyResult>> {
        let Scene { source, observables, settings, .. } = self.scene;
        let (setup, steps) = (self.setup()?, settings.steps);
        let (truncation, key) = (settings.truncation, settings.key);
        let study_settings =
            StudySettings::new(steps, settings.times, settings.paths, truncation, key);
        let observables: Vec<&dyn Observe> =
            observables.iter().map(|observable: &Observable| observable as _).collect();
        let study = Study::new(&setup, &observables, &study_settings);
        let study = study.map_err(|error| settings.steps_error(source, error))?;
        let bars = Bars::default();
        bars.begin("paths", settings.paths * steps);
        let result = study.run_in(job, "study", &|work| bars.advance(work));
        bars.finish();
        Ok(result)
    }
}

/// Refuses to write gigabytes by mistake.
fn check_size(scene: &Scene, formats: &[Format], allowed: bool) -> Done {
    const GIGABYTE: f64 = 1e9;
    let settings = &scene.settings;
    let columns = scene.columns();
    let numbers = settings.tables as f64 * (settings.times + 1) as f64 * columns as f64;
    let bytes = |format: &Format| match format {
        Format::Npz => 8.0,
        // A number in shortest form.
        Format::Csv | Format::Json => 20.0,
    };
    let written: f64 = formats.iter().map(bytes).sum::<f64>() * numbers;
    let held = 8.0 * numbers;
    if written.max(held) > GIGABYTE && !allowed {
        let message = format!(
            "{} tables of {} times and {columns} columns take {:.1} GB of memory and {:.1} GB of \
             files: take fewer `tables` or `times`, or say --large",
            settings.tables,
            settings.times,
            held / GIGABYTE,
            written / GIGABYTE,
        );
        return Err(Failure::Usage(message));
    }
    Ok(())
}

/// Says what was computed and where it is.
pub fn report(scene: &Scene, results: &Results, folder: &Path, json: bool) -> Done {
    if json {
        return print_json(&output::summary(scene, results, folder)?);
    }
    let mut text = String::new();
    let Results { scheme, because, tables, study, check, seconds, .. } = results;
    let lines = check.iter().flat_map(|check| output::step_lines(check, study.as_ref(), scene));
    lines.for_each(|line| text += &format!("warning: {line}\n"));
    let paths = study.as_ref().map_or(tables.len() as u64, |study| study.record.paths);
    let steps = scene.settings.steps;
    let word = if paths == 1 { "path" } else { "paths" };
    text += &format!("{paths} {word}, {steps} steps of {scheme}, {seconds:.2} s\n");
    if let Some(because) = because {
        text += &format!("{scheme}: {because}\n");
    }
    if let Some(study) = study {
        text += &output::table_at_end(study, check.as_ref());
        study.warnings.iter().for_each(|warning| text += &format!("warning: {warning}\n"));
    }
    for (path, table) in tables.iter().enumerate() {
        if let Some(halted) = &table.halted {
            text += &format!("warning: path {path}: {halted}\n");
        }
    }
    text += &format!("report: {}\n", folder.join(folder::REPORT).display());
    print(&text)
}
