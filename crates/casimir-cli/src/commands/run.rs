//! `casimir run`: paths and their statistics.

use std::{path::Path, time::Instant};

use casimir::{
    analysis::{StepCheck, checked_paths, step_check},
    mc::{
        Observe, Setup, Simulation, Study, StudySettings, TimeSeries,
        parts::{Job, Share, Stop, remove},
        study::{StudyResult, Wanted},
    },
    stats::proportion,
};

use super::{
    Settled, folder, print, print_json, scheme, source, threads, under_bar, until_stopped, warn,
};
use crate::{
    arguments::{Format, Run},
    failure::{Done, Failure},
    model::Known,
    output,
    scene::{Combination, Scene, Sweep},
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

/// Runs a scene, at every combination of what is varied, and writes the results.
pub fn run(arguments: &Run) -> Done {
    let sweep = Sweep::new(&source(&arguments.scene)?, &arguments.changes)?;
    threads(arguments.output.threads)?;
    check_size(&sweep, arguments.large)?;
    // The scenes are checked before the folder is made.
    let settled = sweep.combinations.iter().map(|combination| scheme(&combination.scene)).collect();
    let ready = ready(&sweep, settled)?;
    let folder = folder::of(arguments.output.out.clone(), &arguments.scene, "run")?;
    let is_study = sweep.combinations[0].scene.settings.is_study();
    let kept = is_study.then_some(&*folder);
    let (results, stopped) = until_stopped(kept, |job, stop| compute(ready, job, stop).map(Some))?;
    let results = Outcomes { sweep: &sweep, results: results.unwrap_or_default() };
    if stopped && results.paths() == 0 {
        return Err(Failure::stopped("before the first path: nothing was computed"));
    }
    results.write(&folder, &arguments.write, arguments.output.json)?;
    if stopped {
        let folder = folder.display();
        let words = format!("{folder} has what is complete; the same command goes on from there");
        return Err(Failure::stopped(words));
    }
    if let Some(folder) = kept {
        remove(folder, Share::WHOLE)?;
    }
    match results.all_failed() {
        Some(failure) => Err(Failure::run(format!(
            "all paths failed: take more steps, or another scheme; {failure}"
        ))),
        None => Ok(()),
    }
}

/// The runs of all combinations, checked.
pub fn ready(sweep: &Sweep, settled: Vec<Settled>) -> Done<Vec<Ready<'_>>> {
    let both = sweep.combinations.iter().zip(settled);
    both.map(|(combination, settled)| Ready::new(combination, settled)).collect()
}

/// Computes runs one after the other; none where another part has it, or it was not begun.
pub fn compute(ready: Vec<Ready<'_>>, job: &Job, stop: &Stop) -> Done<Vec<Option<Results>>> {
    let one = |ready: Ready<'_>| if stop.is_asked() { Ok(None) } else { ready.compute(job, stop) };
    ready.into_iter().map(one).collect()
}

/// What was found at each combination of a sweep.
pub struct Outcomes<'a> {
    /// What was varied.
    pub sweep: &'a Sweep,
    /// The results, in the order of the combinations; none of those that are not here.
    pub results: Vec<Option<Results>>,
}

impl Outcomes<'_> {
    /// Combinations with their results.
    pub fn found(&self) -> impl Iterator<Item = (&Combination, &Results)> {
        let both = self.sweep.combinations.iter().zip(&self.results);
        both.filter_map(|(combination, results)| Some((combination, results.as_ref()?)))
    }

    /// Number of paths of all.
    fn paths(&self) -> u64 {
        self.found().map(|(_, results)| results.paths()).sum()
    }

    /// The first failure, if no path came to its end.
    fn all_failed(&self) -> Option<String> {
        self.found().map(|(_, results)| results.all_failed()).collect::<Option<Vec<_>>>()?.pop()
    }

    /// Writes what was found, and says it.
    pub fn write(&self, folder: &Path, formats: &[Format], json: bool) -> Done {
        if !self.sweep.varied.is_empty() {
            let found = output::SweepReport::new(self);
            let keys = self.sweep.combinations.iter().map(|one| one.scene.settings.key);
            found.write(folder, formats, keys.is_sorted_by(|a, b| a == b))?;
            return match json {
                true => print_json(&found.summary(folder)?),
                false => print(&found.text(folder)),
            };
        }
        for (Combination { scene, .. }, results) in self.found() {
            output::write(scene, results, folder, formats)?;
            report(scene, results, folder, json)?;
        }
        Ok(())
    }
}

impl Results {
    /// Number of paths.
    pub fn paths(&self) -> u64 {
        self.study.as_ref().map_or(self.tables.len() as u64, |study| study.record.paths)
    }

    /// The first failure, if no path came to its end.
    fn all_failed(&self) -> Option<String> {
        match &self.study {
            Some(study) if study.losses.failed < study.record.paths => None,
            Some(study) => study.losses.failures.first().cloned(),
            None => {
                let halted = self.tables.iter().map(|table| table.halted.clone());
                halted.collect::<Option<Vec<_>>>()?.into_iter().next()
            }
        }
    }

    /// What a reader must know of single paths, of the steps and of the statistics.
    pub fn warnings(&self, scene: &Scene) -> Vec<String> {
        let Self { tables, study, check, .. } = self;
        let steps = check.iter().flat_map(|check| output::step_lines(check, study.as_ref(), scene));
        let warnings = study.iter().flat_map(|study| study.warnings.clone());
        let halted = tables.iter().enumerate().filter_map(|(path, table)| {
            table.halted.as_ref().map(|halted| format!("path {path}: {halted}"))
        });
        let is_few = study.is_none() && scene.wanted != Wanted::default();
        let few = "pairs and autocorrelations are of 100 paths or more: take more `paths`";
        let few = is_few.then(|| few.to_owned());
        steps.chain(warnings).chain(halted).chain(few).collect()
    }
}

/// A run that was checked.
pub struct Ready<'a> {
    label: &'a str,
    scene: &'a Scene,
    scheme: String,
    setup: Setup<'a>,
    because: Option<String>,
}

impl<'a> Ready<'a> {
    /// Checks that the scheme can be run.
    pub fn new(combination: &'a Combination, (scheme, because): Settled) -> Done<Self> {
        let Combination { label, scene, .. } = combination;
        let setup = scene.collecting(scene.setup(&scheme)?);
        let settings = &scene.settings;
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
        Ok(Self { label, scene, scheme, setup, because })
    }

    /// Computes tables and statistics; none if another part has them.
    pub fn compute(self, job: &Job, stop: &Stop) -> Done<Option<Results>> {
        let start = Instant::now();
        let Self { label, scene, scheme, setup, because } = self;
        let of_label = if label.is_empty() { String::new() } else { format!("{label}: ") };
        job.section(&of_label);
        let Scene { components, observables, settings, model, .. } = scene;
        let (steps, truncation, key) = (settings.steps, settings.truncation, settings.key);
        let mut study = None;
        if settings.is_study() {
            let wanted = StudySettings {
                wanted: scene.wanted.clone(),
                ..StudySettings::new(steps, settings.times, settings.paths, truncation, key)
            };
            let of_all = Study::new(&setup, observables, &wanted);
            let of_all = of_all.map_err(|error| scene.steps_error(error))?;
            study = under_bar(&format!("{of_label}paths"), settings.paths * steps, |done| {
                of_all.run_in(job, "study", done)
            });
            study.iter_mut().for_each(|study| with_probabilities(study, &scene.probabilities));
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

/// Gives means that are probabilities their intervals. Quantiles of zeros and ones say nothing.
fn with_probabilities(study: &mut StudyResult, names: &[String]) {
    let before = study.concerns();
    let series = study.series.iter_mut().filter(|series| names.contains(&series.observable));
    for point in series.flat_map(|series| &mut series.points) {
        point.quantiles.clear();
        point.histogram = None;
        let Some(mean) = point.mean.filter(|_| point.step > 0) else { continue };
        let count = (mean * point.count as f64).round() as u64;
        point.mean_interval = Some(proportion(count, point.count));
        point.interval_note = None;
    }
    let after = study.concerns();
    study.warnings.retain(|warning| !before.contains(warning) || after.contains(warning));
}

/// Refuses to write gigabytes by mistake.
fn check_size(sweep: &Sweep, allowed: bool) -> Done {
    let Combination { scene, .. } = &sweep.combinations[0];
    let (settings, columns) = (&scene.settings, scene.columns());
    let (tables, times) = (settings.tables * sweep.combinations.len() as u64, settings.times);
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
fn report(scene: &Scene, results: &Results, folder: &Path, json: bool) -> Done {
    if json {
        return print_json(&output::summary(scene, results, folder)?);
    }
    let Results { scheme, because, tables, study, check, seconds, .. } = results;
    let mut text: String =
        results.warnings(scene).iter().map(|warning| format!("warning: {warning}\n")).collect();
    let (paths, steps) = (results.paths(), scene.settings.steps);
    let word = if paths == 1 { "path" } else { "paths" };
    text += &format!("{paths} {word}, {steps} steps of {scheme}, {seconds:.2} s\n");
    if let Some(because) = because {
        text += &format!("{scheme}: {because}\n");
    }
    text += &match study {
        Some(study) => output::table_at_end(study, check.as_ref()),
        None => output::paths_at_end(scene, tables),
    };
    text += &format!("report: {}\n", folder.join(folder::REPORT).display());
    print(&text)
}
