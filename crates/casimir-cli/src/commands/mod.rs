//! The commands, each in a file of its own.

mod compare;
mod expect;
mod folder;
mod inspect;
mod new;
mod order;
mod parts;
mod run;

use std::{fs, io::Write, path::Path};

use casimir::{
    mc::parts::{Job, JobError, Program, Share, Stop, limit_threads},
    plot::under_bar,
    schemes::BuiltIn,
    systems::Linearity,
};
use serde::Serialize;

pub use compare::compare;
pub use expect::{Results as Expected, expect};
pub use inspect::inspect;
pub use new::new;
pub use order::order;
pub use parts::{extend, merge, part, plan};
pub use run::{Outcomes, Results, run};

use crate::{
    failure::{Done, Failure},
    model::Known,
    scene::{AUTO, Changes, Scene, Source},
};

/// Reads a scene and checks it.
fn open(file: &Path, changes: &Changes) -> Done<Scene> {
    Ok(Scene::new(source(file)?, changes)?)
}

/// The text of a scene.
fn source(file: &Path) -> Done<Source> {
    let name = file.display().to_string();
    let text = fs::read_to_string(file)
        .map_err(|error| Failure::usage(format!("cannot read the scene {name}: {error}")))?;
    Ok(Source { name, text })
}

/// The scheme of a scene, and why it was chosen if that was left to the program, or what it loses
/// over long times.
fn scheme(scene: &Scene) -> Settled {
    let (auto, because) = scene.model.recommended();
    let named = &scene.settings.scheme;
    if named == AUTO {
        return (auto.into(), Some(because));
    }
    let constant = scene.model.system().description().linearity == Linearity::Constant;
    let explicit = BuiltIn::named(named).filter(|scheme| scheme.is_explicit(constant));
    let loses = |scheme: BuiltIn| format!("{}; auto takes {auto}", scheme.long_times(constant));
    (named.clone(), explicit.map(loses))
}

/// A scheme, and why it was chosen if that was left to the program: what `plan` settles, so that
/// no part inspects the system.
type Settled = (String, Option<String>);

/// Prints what is wrong. Whoever has a wrong system should know before its numbers.
fn warn(scene: &Scene) -> Known {
    let known = scene.model.known();
    known.mistake.iter().for_each(|mistake| eprintln!("warning: {mistake}"));
    known
}

/// Steps of the coarsest level: an eighth of a unit of time or shorter. Finer levels follow from
/// what is measured.
fn coarsest_steps(until: f64) -> u64 {
    let most = f64::from(1u32 << 24);
    ((8.0 * until).ceil().clamp(4.0, most) as u64).next_power_of_two()
}

/// This program, as files of parts name it.
fn program() -> Program {
    Program { name: "casimir".into(), version: env!("CARGO_PKG_VERSION").into() }
}

/// What a signal stops. A second one ends the process at once.
fn stop() -> Stop {
    let stop = Stop::default();
    if let Err(error) = stop.on_signals() {
        eprintln!("warning: Ctrl-C loses what is not in a checkpoint: {error}");
    }
    stop
}

fn threads(threads: Option<u64>) -> Done {
    Ok(threads.map_or(Ok(()), limit_threads)?)
}

/// Computes with a job, which has checkpoints if there is a folder, until a signal stops it; and
/// whether one did.
fn until_stopped<R>(
    folder: Option<&Path>,
    compute: impl FnOnce(&Job, &Stop) -> Done<Option<R>>,
) -> Done<(Option<R>, bool)> {
    let stop = stop();
    let job = match folder {
        Some(folder) => Job::part(folder, Share::WHOLE, program())?,
        None => Job::here(),
    };
    if let (true, Some(folder)) = (job.resumes(), folder) {
        let file = folder.join(Share::WHOLE.file_name());
        eprintln!("going on from a checkpoint; to begin anew, delete {}", file.display());
    }
    let job = job.stopped_by(&stop).giving_what_is_done();
    let results = compute(&job, &stop)?;
    match job.finish() {
        Err(JobError::Stopped) => Ok((results, true)),
        finished => {
            finished?;
            Ok((results, stop.is_asked()))
        }
    }
}

/// Prints to the standard output; a reader that went away is no error.
fn print(text: &str) -> Done {
    match std::io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}

fn print_json(value: &impl Serialize) -> Done {
    print(&format!("{}\n", serde_json::to_string_pretty(value)?))
}

/// Prints the JSON schema of scenes.
pub fn schema() -> Done {
    print_json(&crate::scene::schema())
}
