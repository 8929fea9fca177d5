//! `casimir plan`, `part`, `merge` and `extend`: a scene on many machines.

use std::fs;

use casimir::mc::parts::{JobError, hash, merged_paths};
use scenes::{Changes, Sweep};
use serde::Deserialize;
use verbs::{
    self, Outcomes, Settled,
    output::{
        Format,
        cluster::{JOB, Script},
    },
    program,
};

use super::{scene::write, *};
use crate::arguments::Plan;

/// Plan of a run in parts: `plan.json` in the folder of the parts, beside the scene.
#[derive(Serialize, Deserialize)]
struct Divided {
    /// Number of parts.
    parts: u64,
    /// Changes made by the command line.
    #[serde(flatten)]
    changes: Changes,
    /// The scheme that `auto` means in all parts, and why; for each combination.
    settled: Vec<Settled>,
    /// Hash of the rest and of the meaning of the scene.
    sum: String,
}

const PLAN: &str = "plan.json";
const SCENE: &str = "scene.toml";
/// Time for which each piece of work is measured for a plan.
const MEASURED: Duration = Duration::from_millis(300);

/// Content of a folder of parts.
struct Folder {
    divided: Divided,
    sweep: Sweep,
}

impl Folder {
    fn open(folder: &Path, on: Machine) -> Done<Self> {
        let file = folder.join(PLAN);
        let text = fs::read(&file).map_err(serde_json::Error::io);
        let divided =
            text.and_then(|text| serde_json::from_slice::<Divided>(&text)).map_err(|error| {
                Failure::Usage(format!(
                    "{} does not say what its parts are: {error}",
                    file.display()
                ))
            })?;
        let sweep = Sweep::new(
            &Source { device: device(on)?, ..source("scene", &folder.join(SCENE))? },
            &divided.changes,
        )?;
        let opened = Self { divided, sweep };
        if opened.divided.sum != opened.sum()? {
            return refuse(format!(
                "{}: {PLAN} or {SCENE} was changed since `casimir plan`: put back what was there, \
                 or plan in another folder",
                folder.display()
            ));
        }
        Ok(opened)
    }

    /// This program and what it computes in the folder.
    fn program(&self) -> Program {
        program(
            self.sweep.scene(),
            &self
                .divided
                .settled
                .iter()
                .map(|(scheme, _)| format!("scheme = {scheme}\n"))
                .collect::<String>(),
        )
    }

    /// Hash of the whole plan.
    fn sum(&self) -> Done<String> {
        let Divided { parts, changes, settled, .. } = &self.divided;
        Ok(hash(&serde_json::to_string(&(parts, changes, settled, self.program().input))?))
    }

    /// Writes the plan.
    fn write(mut self, folder: &Path) -> Done {
        self.divided.sum = self.sum()?;
        Ok(files::write_json(&folder.join(PLAN), &self.divided)?)
    }

    /// Computes the runs of the folder as parts of a job; returns the results if there are some
    /// here.
    fn compute(&self, job: &Job, watch: &Watch) -> Done<Outcomes<'_>> {
        verbs::compute(
            &self.sweep,
            verbs::ready(&self.sweep, self.divided.settled.clone())?,
            job,
            watch,
        )
    }
}

/// Writes the plan of a run in parts, and a job script that starts `program`.
pub fn plan(
    Plan { scene, parts, out, cpus, sbatch: options, changes }: &Plan,
    program: &Path,
) -> Done {
    let source = source("scene", scene)?;
    let sweep = Sweep::new(&source, changes)?;
    let settings = &sweep.scene().settings;

    if !settings.is_study() {
        return refuse("a few paths are not divided: take at least 100 `paths`, or `casimir run`");
    }
    Share::new(1, *parts)?;
    if out.join(PLAN).exists() {
        let out = out.display();
        return refuse(format!(
            "{out} has parts already: take another folder, or casimir extend {out}"
        ));
    }
    prepare(out)?;
    files::write(&out.join(SCENE), &source.text)?;
    if let Some(states) = &settings.states {
        let copy = out.join(states);
        files::prepare(files::folder(&copy))?;
        // Read first: by an absolute path the copy is the file itself.
        files::write(&copy, fs::read(scene.with_file_name(states))?)?;
    }
    let (parts, changes, settled) = (*parts, changes.clone(), verbs::settle(&sweep));
    let opened = Folder { divided: Divided { parts, changes, settled, sum: String::new() }, sweep };
    let job = Job::pilot(MEASURED);
    opened.compute(&job, &watch())?;
    let planned = job.plan()?;
    let (cpus, folder) = (*cpus.max(&1), fs::canonicalize(out)?);
    let seconds =
        |parts, threads| planned.iter().map(|work| work.seconds(parts, threads)).sum::<f64>();
    let part_seconds = seconds(parts, cpus);
    // Twice as long as measured, and a minute to start.
    let minutes = 1 + (2.0 * part_seconds / 60.0).ceil() as u64;

    let script = Script { parts, program, folder: &folder, minutes, cpus, options };
    files::write(&out.join(JOB), script.slurm())?;
    // Last: a folder with a plan is complete.
    opened.write(out)?;
    let (mut words, mut path_steps) = (String::new(), 0);
    for work in &planned {
        words += &format!("{}: {} paths of {} steps\n", work.name, work.paths, work.steps);
        path_steps += work.paths * work.steps;
    }
    let nanoseconds = 1e9 * seconds(1, 1) / path_steps as f64;
    print(&format!(
        "{words}{:.3e} path-steps, {nanoseconds:.1} ns each on one thread; {parts} parts of about \
         {part_seconds:.0} s\n{}",
        path_steps as f64,
        script.lines()
    ))
}

/// Computes one part.
pub fn part(folder: &Path, part: u64, cpus: Option<u64>, on: Machine) -> Done {
    cpus.map_or(Ok(()), limit_threads)?;
    let opened = Folder::open(folder, on)?;
    let share = Share::new(part, opened.divided.parts)?;
    let watch = stoppable();
    let job = Job::part(folder, share, opened.program())?.stopped_by(&watch.stop);
    opened.compute(&job, &watch)?;
    match job.finish() {
        Ok(()) | Err(JobError::Stopped) if watch.stop.is_asked() => {
            Err(Failure::Stopped("the same command goes on from the checkpoint".into()))
        }
        finished => {
            finished?;
            print(&format!("{share} is done; when all are: casimir merge {}\n", folder.display()))
        }
    }
}

/// Puts the parts together.
pub fn merge(folder: &Path, formats: &[Format], json: bool) -> Done {
    let opened = Folder::open(folder, Machine::Cpu)?;
    files::check(folder)?;
    let watch = stoppable();
    let job = Job::merge(folder, opened.program())?.stopped_by(&watch.stop);
    let found = opened.compute(&job, &watch)?;
    let merged = job.finish();
    if watch.stop.is_asked() {
        merged?;
        return Err(Failure::Stopped("the same command merges them".into()));
    }
    // Whether or not the file of what was merged can be written.
    if found.results.iter().all(Option::is_some) {
        write(&found, folder, formats, json)?;
    }
    Ok(merged?)
}

/// Asks for more paths in a folder.
pub fn extend(folder: &Path, paths: u64) -> Done {
    let mut opened = Folder::open(folder, Machine::Cpu)?;
    let before = opened.sweep.scene().settings.paths;
    if paths <= before {
        return refuse(format!("ask for more than {before} paths: --paths N"));
    }
    opened.divided.changes.paths = Some(paths);
    let merged = merged_paths(folder, &opened.program())?;
    let mut studies = merged.iter().filter(|(name, _)| name.ends_with("study"));
    let (parts, name) = (opened.divided.parts, folder.display());
    if merged.is_empty() || studies.any(|(_, merged)| *merged != before) {
        return refuse(format!("the parts are not merged yet: casimir merge {name}, then extend"));
    }
    opened.write(folder)?;
    print(&format!(
        "now compute parts 1 to {parts} again (sbatch {name}/{JOB}), and casimir merge {name}\n"
    ))
}
