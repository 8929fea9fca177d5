//! The commands.

mod about;
mod parts;
mod scene;

use std::{
    io::Write,
    path::{Path, PathBuf},
    process,
    sync::{Arc, OnceLock},
    thread,
    time::{Duration, Instant},
};

use casimir::{
    mc::{
        files,
        parts::{Job, Program, Share, Stop, limit_threads},
    },
    schemes::Device,
};
use indicatif::{ProgressBar, ProgressStyle};
use scenes::{SceneError, Source};
use serde::Serialize;
#[cfg(unix)]
use signal_hook::{
    consts::{SIGINT, SIGTERM},
    iterator::Signals,
};
use verbs::{
    Found, Progress, Watch,
    failure::{Done, Failure, refuse},
    source,
};

pub use about::{citation, doctor, new, schema};
pub use parts::{extend, merge, part, plan};
pub use scene::{compute, run};

use crate::arguments::{Machine, On};

/// Reads the scene of a command, checks it and the folder, and limits the number of threads if
/// asked for.
fn read<T>(on: &On, read: impl FnOnce(Source) -> Result<T, SceneError>) -> Done<T> {
    let source = source("scene", &on.scene)?;
    // Before large scenes are read, on all threads.
    on.threads.map_or(Ok(()), limit_threads)?;
    let read = watch().under(READING, 0, |_| read(source))?;
    on.out.as_deref().map_or(Ok(()), files::check)?;
    Ok(read)
}

/// Name of the work that takes long with large systems.
const READING: &str = "reading the scene";

/// The machine of a command, once it is known.
static DEVICE: OnceLock<Arc<dyn Device>> = OnceLock::new();

/// The machine that advances paths beside the processor.
fn device(on: Machine) -> Done<Option<Arc<dyn Device>>> {
    if on == Machine::Cpu {
        return Ok(None);
    }
    let device = card().map_err(Failure::Run)?;
    Ok(Some(Arc::clone(DEVICE.get_or_init(|| device))))
}

/// The first graphics card.
///
/// # Errors
/// The reason why there is none.
#[cfg(feature = "gpu")]
pub fn card() -> Result<Arc<dyn Device>, String> {
    Ok(Arc::new(gpu::Gpu::new(gpu::Card::first().map_err(|error| error.to_string())?)))
}

/// No graphics card.
///
/// # Errors
/// Always: the program was built without cards.
#[cfg(not(feature = "gpu"))]
pub fn card() -> Result<Arc<dyn Device>, String> {
    Err("this program was built without cards: build it with `--features gpu`".into())
}

/// Says which paths were not computed on the machine that was asked for.
pub fn left_to_processor() {
    for why in DEVICE.get().iter().flat_map(|device| device.refused()) {
        eprintln!("note: paths were computed on the processor: {why}");
    }
}

/// A job with checkpoints in a folder.
fn keeping(folder: &Path, program: Program, watch: &Watch) -> Done<Job> {
    let job = Job::part(folder, Share::WHOLE, program)?;
    if job.resumes() {
        going_on(&folder.join(Share::WHOLE.file_name()));
    }
    Ok(job.stopped_by(&watch.stop).giving_what_is_done())
}

/// Says that work goes on from a file.
fn going_on(file: &Path) {
    eprintln!("going on from {}; to begin anew, delete it", file.display());
}

/// A bar on the terminal.
struct Bar(ProgressBar);

impl Progress for Bar {
    fn begin(&self, what: &str, path_steps: u64) {
        let template = match path_steps {
            0 => "{elapsed:>4} {spinner} {msg}",
            _ => "{elapsed:>4} [{bar:28}] {percent:>3}% {msg}, {eta} left",
        };
        self.0.set_style(
            ProgressStyle::with_template(template)
                .expect("the template is valid")
                .progress_chars("=> "),
        );
        self.0.set_length(path_steps);
        self.0.reset();
        self.message(what);
        if self.is_seen() {
            self.0.enable_steady_tick(Duration::from_millis(200));
        }
    }

    fn advance(&self, path_steps: u64) {
        self.0.inc(path_steps);
    }

    fn message(&self, words: &str) {
        self.0.set_message(words.to_owned());
    }

    fn end(&self) {
        self.0.finish_and_clear();
    }

    fn is_seen(&self) -> bool {
        !self.0.is_hidden()
    }

    fn say(&self, words: &str) {
        self.0.suspend(|| eprintln!("{words}"));
    }
}

/// A bar on the terminal; a signal ends the process.
fn watch() -> Watch {
    Watch::new(Bar(ProgressBar::new(0)))
}

/// Time within which signals count as one request: it may come as two.
const ONE_WISH: Duration = Duration::from_secs(1);

/// Request that ends [`stoppable`] work.
static STOP: OnceLock<Stop> = OnceLock::new();

/// Ends the process at Ctrl-C and SIGTERM. Work that is [`stoppable`] ends by itself, and at a
/// second signal the process does.
pub fn handle_signals() {
    let mut first = None;
    let handled = on_signals(move || {
        let Some(stop) = STOP.get() else {
            eprintln!("stopped: what is not printed or written yet is lost");
            process::exit(130);
        };
        let asked = *first.get_or_insert_with(Instant::now);
        if !stop.is_asked() {
            eprintln!("stopping; once more to stop without a checkpoint");
            stop.now();
        } else if asked.elapsed() > ONE_WISH {
            process::exit(130);
        }
    });
    if let Err(error) = handled {
        eprintln!("warning: Ctrl-C loses what is not in a checkpoint: {error}");
    }
}

/// Calls `act` at Ctrl-C and SIGTERM. SIGHUP keeps what `nohup` made of it.
#[cfg(unix)]
fn on_signals(mut act: impl FnMut() + Send + 'static) -> std::io::Result<()> {
    let mut signals = Signals::new([SIGINT, SIGTERM])?;
    thread::spawn(move || signals.forever().for_each(|_| act()));
    Ok(())
}

#[cfg(not(unix))]
use ctrlc::set_handler as on_signals;

/// Bar on the terminal for work that a signal stops: it keeps what it has.
fn stoppable() -> Watch {
    let watch = watch();
    _ = STOP.set(watch.stop.clone());
    watch
}

/// Prints to the standard output; a reader that went away is no error.
fn print(text: &str) -> Done {
    match std::io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::Run(format!("cannot print: {error}")))
        }
        _ => Ok(()),
    }
}

/// The folder of results, which can be written: the one asked for, or `<scene>-<command>` here.
fn folder(on: &On, command: &str) -> Done<PathBuf> {
    let mut name = on.scene.file_stem().unwrap_or_default().to_owned();
    name.push(format!("-{command}"));
    let folder = on.out.clone().unwrap_or(name.into());
    files::check(&folder)?;
    Ok(folder)
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

/// Prints the result of a command, and writes figures and JSON into a folder, if there is one.
fn tell(found: &Found, folder: Option<&Path>, file: &str, json: bool) -> Done {
    // First, and whatever becomes of the files.
    let told = if json { print_json(&found.json) } else { print(&found.text) };
    let written = folder.map_or(Ok(String::new()), |folder| store(found, folder, file))?;
    told?;
    if json { Ok(()) } else { print(&written) }
}

/// Writes figures and JSON into a folder; returns lines with the figures.
fn store(found: &Found, folder: &Path, file: &str) -> Done<String> {
    files::prepare(folder)?;
    files::write_json(&folder.join(format!("{file}.json")), &found.json)?;
    let mut written = String::new();
    for figure in &found.figures {
        let file = folder.join(format!("{}.svg", figure.file));
        files::write(&file, &figure.svg)?;
        written += &format!("figure: {}\n", file.display());
    }
    Ok(written)
}

fn print_json(value: &impl Serialize) -> Done {
    print(&(serde_json::to_string_pretty(value)? + "\n"))
}
