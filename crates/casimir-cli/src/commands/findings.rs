//! `casimir inspect`, `expect`, `equilibrium`, `lyapunov`, `order` and `compare`: what is found of
//! a scene.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::Arc,
};

use casimir::mc::{
    Checkpoint,
    parts::{Job, JobError, Program, Share, remove},
};
use casimir_cli::{
    failure::{Done, Failure},
    scene::SchemeAndSeed,
    verbs::{self, Found, Watch},
};

use super::{folder, going_on, keeping, open, program, stoppable, tell, watch};
use crate::arguments::{Compare, Equilibrium, Expect, Inspect, Lyapunov, On, Order};

/// The layout of chains in their file.
const LAYOUT: u32 = 2;
/// The accuracy of exponents.
const ACCURACY: f64 = 0.01;

/// Says what a system is. The scheme of the scene is not asked for.
pub fn inspect(Inspect { sets, on }: &Inspect) -> Done {
    let sets = SchemeAndSeed { sets: sets.clone(), ..SchemeAndSeed::default() };
    let scene = open(on, &sets, None)?;
    tell(&verbs::inspect(&scene, &watch())?, on.out.clone(), "inspect", on.json)
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
            return Err(Failure::Stopped(words));
        }
        Err(error @ JobError::File { .. }) => eprintln!("warning: no checkpoint: {error}"),
        // Or the time is over.
        Ok(()) | Err(JobError::Stopped) => {}
        Err(error) => return Err(error.into()),
    }
    let told = found.and_then(|found| tell(&found, Some(folder.clone()), command, on.json));
    // With an answer, or with a wrong question, there is nothing to go on from.
    if !matches!(told, Err(Failure::Run(_) | Failure::Stopped(_))) {
        remove(&folder, Share::WHOLE)?;
        new.iter().for_each(|folder| drop(fs::remove_dir(folder)));
    }
    told
}

/// Computes the expectations of a scene.
pub fn expect(Expect { accuracy, steps, scheme, on }: &Expect) -> Done {
    let mut scene = open(on, scheme, *steps)?;
    scene.accuracy = accuracy.or(scene.accuracy);
    let file = folder(on, "expect")?.join("samples.bin");
    let kept = checkpoint(file, program(&scene, "verb = expect\n"))?;
    let watch = stoppable();
    let found = verbs::expect(&scene, Some(&kept), &watch);
    finish(found, on.out.clone(), ("expectation", on.json), &watch, &kept)
}

/// Averages over the stationary law.
pub fn equilibrium(arguments: &Equilibrium) -> Done {
    chains(arguments, "equilibrium", None)
}

/// Lyapunov exponents.
pub fn lyapunov(Lyapunov { count, chains: arguments }: &Lyapunov) -> Done {
    chains(arguments, "lyapunov", Some(*count as usize))
}

fn chains(arguments: &Equilibrium, command: &str, exponents: Option<usize>) -> Done {
    let Equilibrium { accuracy, steps, chains, path_steps, scheme, on } = arguments;
    let mut scene = open(on, scheme, *steps)?;
    scene.accuracy = accuracy.or(exponents.map_or(scene.accuracy, |_| Some(ACCURACY)));
    let (folder, count) = (folder(on, command)?, exponents.unwrap_or(0));
    let further = format!("chains = {chains}\nexponents = {count}\nlayout = {LAYOUT}\n");
    let kept = checkpoint(folder.join("chains.bin"), program(&scene, &further))?;
    let watch = stoppable();
    let limits = (*chains, *path_steps);
    let found = verbs::equilibrium(&scene, exponents, limits, Some(&kept), &watch);
    finish(found, Some(folder), (command, on.json), &watch, &kept)
}

/// Says what was found and what is kept; whether it was stopped or its accuracy not reached is the
/// exit code.
fn finish(
    found: Done<Found>,
    folder: Option<PathBuf>,
    (file, json): (&str, bool),
    watch: &Watch,
    kept: &Checkpoint,
) -> Done {
    let told = found.and_then(|found| tell(&found, folder, file, json).map(|()| found.unreached));
    let file = kept.file().display();
    if let Some(error) = kept.failure() {
        eprintln!("warning: the samples are not kept in {file}: {error}");
    }
    let next = || match kept.holds() {
        Ok(true) => format!("samples are in {file}: the same command goes on from them"),
        _ => "no samples are kept: the same command begins anew".into(),
    };
    match told {
        Err(Failure::Stopped(words)) => Err(Failure::Stopped(format!("{words}; {}", next()))),
        Ok(_) if watch.stop.is_asked() => Err(Failure::Stopped(next())),
        Ok(Some(words)) => Err(Failure::Run(words)),
        told => told.map(drop),
    }
}

/// A file for samples or chains.
fn checkpoint(file: PathBuf, program: Program) -> Done<Checkpoint> {
    let checkpoint = Checkpoint::new(file, program);
    if checkpoint.holds()? {
        going_on(checkpoint.file());
    }
    Ok(checkpoint)
}
