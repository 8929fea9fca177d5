//! The commands.

mod about;
mod findings;
mod parts;
mod run;

use std::{
    fs,
    io::Write,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use casimir::{
    mc::parts::{Program, Stop, limit_threads},
    plot::files,
};
use casimir_cli::{
    failure::{Done, Failure},
    scene::{Changes, Scene, SchemeAndSeed, Source},
    verbs::{Found, ProgressBar, Watch},
};
use serde::Serialize;

pub use about::{citation, doctor, new, schema};
pub use findings::{compare, equilibrium, expect, inspect, lyapunov, order};
pub use parts::{extend, merge, part, plan};
pub use run::run;

use crate::arguments::On;

/// Reads a scene and checks it and the folder, and takes as many threads as are asked for.
fn open(on: &On, scheme: &SchemeAndSeed, steps: Option<u64>) -> Done<Scene> {
    let changes = Changes { scheme: scheme.clone(), steps, ..Changes::default() };
    let source = source(&on.scene)?;
    let scene = watch().under(READING.into(), 0, || Scene::new(source, &changes))?;
    threads(on.threads)?;
    on.out.as_deref().map_or(Ok(()), files::prepare)?;
    Ok(scene)
}

/// What takes long with large systems.
const READING: &str = "reading the scene";

/// The text of a scene.
fn source(file: &Path) -> Done<Source> {
    let name = file.display().to_string();
    let text = fs::read_to_string(file)
        .map_err(|error| Failure::Usage(format!("cannot read the scene {name}: {error}")))?;
    Ok(Source { name, text, states: None })
}

/// This program, as files of parts name it.
fn program() -> Program {
    Program { name: "casimir".into(), version: env!("CARGO_PKG_VERSION").into() }
}

/// A bar on the terminal; nothing stops the work but the end of the process.
fn watch() -> Watch {
    let say = |words: &str| eprintln!("{words}");
    Watch { bar: ProgressBar::new(0), say, stop: Stop::default() }
}

/// Signals within this time are one wish: it may come as two.
const ONE_WISH: Duration = Duration::from_secs(1);

/// The same, stopped by Ctrl-C and by SIGTERM. A second signal ends the process at once.
fn stoppable() -> Watch {
    let watch = watch();
    let (stop, mut first) = (watch.stop.clone(), None);
    let handled = ctrlc::set_handler(move || {
        let asked = *first.get_or_insert_with(Instant::now);
        if !stop.is_asked() {
            eprintln!("stopping; once more to stop without a checkpoint");
            stop.now();
        } else if asked.elapsed() > ONE_WISH {
            std::process::exit(130);
        }
    });
    if let Err(error) = handled {
        eprintln!("warning: Ctrl-C loses what is not in a checkpoint: {error}");
    }
    watch
}

fn threads(threads: Option<u64>) -> Done {
    Ok(threads.map_or(Ok(()), limit_threads)?)
}

/// Prints to the standard output; a reader that went away is no error.
fn print(text: &str) -> Done {
    match std::io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}

/// The folder of results: the one asked for, or `<scene>-<command>` here.
fn folder(on: &On, command: &str) -> PathBuf {
    let stem = on.scene.file_stem().unwrap_or_default().to_string_lossy();
    on.out.clone().unwrap_or_else(|| format!("{stem}-{command}").into())
}

/// The report in a folder.
const REPORT: &str = "index.html";

/// Checks that a folder can be written, and says if it has results that will be replaced.
fn prepare(folder: &Path) -> Done {
    let replaces = folder.join(REPORT).exists();
    files::prepare(folder)?;
    if replaces {
        eprintln!("note: the results in {} will be replaced", folder.display());
    }
    Ok(())
}

/// Writes figures and JSON into a folder, if there is one, and says what was found.
fn tell(found: &Found, folder: Option<PathBuf>, file: &str, json: bool) -> Done {
    let mut text = found.text.clone();
    if let Some(folder) = folder {
        files::prepare(&folder)?;
        files::write_json(&folder.join(format!("{file}.json")), &found.json)?;
        for figure in &found.figures {
            let file = folder.join(format!("{}.svg", figure.file));
            files::write(&file, &figure.svg)?;
            text += &format!("figure: {}\n", file.display());
        }
    }
    if json { print_json(&found.json) } else { print(&text) }
}

fn print_json(value: &impl Serialize) -> Done {
    print(&format!("{}\n", serde_json::to_string_pretty(value)?))
}
