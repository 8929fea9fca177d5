//! The commands.

mod citation;
mod doctor;
mod expect;
mod findings;
mod folder;
mod new;
mod parts;
mod run;
mod stationary;

use std::{
    fs,
    io::Write,
    path::Path,
    time::{Duration, Instant},
};

use casimir::{
    mc::parts::{Program, Stop, limit_threads},
    plot::files,
};
use casimir_cli::{
    failure::{Done, Failure},
    scene::{Changes, Scene, Source},
    verbs::{Found, ProgressBar, Watch},
};
use serde::Serialize;

pub use citation::citation;
pub use doctor::doctor;
pub use expect::expect;
pub use findings::{compare, inspect, order};
pub use new::new;
pub use parts::{extend, merge, part, plan};
pub use run::run;
pub use stationary::{equilibrium, lyapunov};

/// Reads a scene and checks it.
fn open(file: &Path, changes: &Changes) -> Done<Scene> {
    Ok(Scene::new(source(file)?, changes)?)
}

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

/// Writes figures and JSON into a folder, if there is one, and says what was found.
fn tell(found: &Found, folder: Option<&Path>, command: &str, json: bool) -> Done {
    let mut text = found.text.clone();
    if let Some(folder) = folder {
        files::write_json(&folder.join(format!("{command}.json")), &found.json)?;
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

/// Prints the JSON schema of scenes.
pub fn schema() -> Done {
    print_json(&casimir_cli::scene::schema())
}
