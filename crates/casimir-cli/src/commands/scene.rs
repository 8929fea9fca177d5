//! `casimir run`, `inspect`, `expect`, `equilibrium`, `lyapunov`, `order` and `compare`: commands
//! on a scene.

use std::{fs, path::Path, sync::Arc};

use casimir::mc::{
    Checkpoint,
    parts::{Job, JobError, Program, Share, remove},
};
use scenes::{SchemeAndSeed, Sweep};
use verbs::{
    self, Found, Outcomes, Watch,
    failure::{
        Done,
        Failure::{self, Stopped},
    },
    output::Format,
};

use super::{
    READING, REPORT, folder, going_on, keeping, open, prepare, print, print_json, program, read,
    stoppable, tell, watch,
};
use crate::arguments::{Compare, Equilibrium, Expect, Inspect, Lyapunov, On, Order, Run};

/// Runs a scene, at every combination of what is varied, and writes the results.
pub fn run(Run { changes, write: formats, large, on }: &Run) -> Done {
    let sweep = read(on, |source| Sweep::new(&source, changes))?;
    if !(formats.is_empty() || *large) {
        check_size(&sweep)?;
    }
    // The scenes are checked before the folder is made.
    let ready = watch().under(READING, 0, |_| verbs::ready(&sweep, verbs::settle(&sweep)))?;
    let folder = folder(on, "run")?;
    prepare(&folder)?;
    let is_study = sweep.scene().settings.is_study();
    let kept = is_study.then_some(&*folder);
    let watch = stoppable();
    let job = match kept {
        Some(folder) => keeping(folder, program(sweep.scene(), ""), &watch)?,
        None => Job::here().stopped_by(&watch.stop).giving_what_is_done(),
    };
    let results = verbs::compute(&sweep, ready, &job, &watch)?;
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
        return Err(Stopped("before the first results: nothing is written".into()));
    }
    write(&results, &folder, formats, on.json)?;
    if stopped {
        let folder = folder.display();
        let words = format!("{folder} has what is complete; the same command {next}");
        return Err(Stopped(words));
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
        return Err(Failure::Usage(format!(
            "{rows} rows of {columns} columns are {gigabytes:.1} GB of text: take fewer `tables` \
             or `times`, or say --large"
        )));
    }
    Ok(())
}

/// Version of the layout of chains in their file.
const LAYOUT: u32 = 2;
/// Default accuracy of Lyapunov exponents.
const ACCURACY: f64 = 0.01;

/// Describes a system. The scheme of the scene is not asked for.
pub fn inspect(Inspect { sets, on }: &Inspect) -> Done {
    let sets = SchemeAndSeed { sets: sets.clone(), ..SchemeAndSeed::default() };
    let scene = open(on, &sets, None)?;
    tell(&verbs::inspect(&scene, &watch())?, on.out.as_deref(), "inspect", on.json)
}

/// Measures the orders of a scheme on a scene.
pub fn order(Order { path_steps, scheme, on }: &Order) -> Done {
    let scene = open(on, scheme, None)?;
    kept(on, "order", program(&scene, &format!("path steps = {path_steps}\n")), |job, watch| {
        verbs::order(&scene, *path_steps, Some(job), watch)
    })
}

/// Compares all schemes on a scene.
pub fn compare(Compare { error, budget, sets, seed, on }: &Compare) -> Done {
    let seed = SchemeAndSeed { scheme: None, seed: *seed, sets: sets.clone() };
    let scene = open(on, &seed, None)?;
    kept(on, "compare", program(&scene, &format!("error = {error}\n")), |job, watch| {
        verbs::compare(&scene, *error, *budget, Some(job), watch)
    })
}

/// Does work as a job that keeps it, and says what was found.
fn kept(
    on: &On,
    command: &str,
    program: Program,
    work: impl FnOnce(&Arc<Job>, &Watch) -> Done<Found>,
) -> Done {
    let (folder, watch) = (folder(on, command)?, stoppable());
    let new: Vec<&Path> = folder.ancestors().take_while(|folder| !folder.exists()).collect();
    let job = Arc::new(keeping(&folder, program, &watch)?);
    let found = work(&job, &watch);
    match Arc::into_inner(job).map_or(Ok(()), Job::finish) {
        Ok(()) | Err(JobError::Stopped) if watch.stop.is_asked() => {
            let folder = folder.display();
            let words = format!("{folder} has what was measured; the same command goes on");
            return Err(Stopped(words));
        }
        Err(error @ JobError::File { .. }) => eprintln!("warning: no checkpoint: {error}"),
        // Or the time is over.
        Ok(()) | Err(JobError::Stopped) => {}
        Err(error) => return Err(error.into()),
    }
    let told = found.and_then(|found| tell(&found, Some(&folder), command, on.json));
    // With an answer, or with a wrong question, there is nothing to go on from.
    if !matches!(told, Err(Failure::Run(_) | Stopped(_))) {
        remove(&folder, Share::WHOLE)?;
        new.iter().for_each(|folder| drop(fs::remove_dir(folder)));
    }
    told
}

/// Computes the expectations of a scene.
pub fn expect(Expect { accuracy, steps, scheme, on }: &Expect) -> Done {
    let mut scene = open(on, scheme, *steps)?;
    scene.accuracy = accuracy.or(scene.accuracy);
    let (file, to) = (folder(on, "expect")?.join("samples.bin"), on.out.as_deref());
    let program = program(&scene, "verb = expect\n");
    estimated(&file, program, (to, "expectation", on.json), |kept, watch| {
        verbs::expect(&scene, Some(kept), watch)
    })
}

/// Averages over the stationary law.
pub fn equilibrium(arguments: &Equilibrium) -> Done {
    chains(arguments, "equilibrium", None)
}

/// Computes Lyapunov exponents.
pub fn lyapunov(Lyapunov { count, chains: arguments }: &Lyapunov) -> Done {
    chains(arguments, "lyapunov", Some(*count as usize))
}

fn chains(arguments: &Equilibrium, command: &str, exponents: Option<usize>) -> Done {
    let Equilibrium { accuracy, steps, chains, path_steps, scheme, on } = arguments;
    let mut scene = open(on, scheme, *steps)?;
    scene.accuracy = accuracy.or(exponents.map_or(scene.accuracy, |_| Some(ACCURACY)));
    let (folder, count) = (folder(on, command)?, exponents.unwrap_or(0));
    let further = format!("chains = {chains}\nexponents = {count}\nlayout = {LAYOUT}\n");
    let (file, program) = (folder.join("chains.bin"), program(&scene, &further));
    estimated(&file, program, (Some(&folder), command, on.json), |kept, watch| {
        verbs::equilibrium(&scene, exponents, (*chains, *path_steps), Some(kept), watch)
    })
}

/// Does work whose samples are kept in a file, and says what was found and what is kept; whether it
/// was stopped or its accuracy not reached is the exit code.
fn estimated(
    file: &Path,
    program: Program,
    (to, name, json): (Option<&Path>, &str, bool),
    work: impl FnOnce(&Checkpoint, &Watch) -> Done<Found>,
) -> Done {
    let (kept, watch) = (Checkpoint::new(file, program), stoppable());
    if kept.holds()? {
        going_on(file);
    }
    let found = work(&kept, &watch);
    let told = found.and_then(|found| tell(&found, to, name, json).map(|()| found.unreached));
    let file = file.display();
    if let Some(error) = kept.failure() {
        eprintln!("warning: the samples are not kept in {file}: {error}");
    }
    let next = || match kept.holds() {
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
