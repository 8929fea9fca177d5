//! Calls that take long: without the lock of the interpreter, on threads of their own, watched by
//! the thread that called.

use std::{
    sync::{
        Arc, Mutex, PoisonError,
        mpsc::{self, RecvTimeoutError},
    },
    thread,
    time::{Duration, Instant},
};

use casimir::mc::parts::Stop;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::{exceptions::PyKeyboardInterrupt, prelude::*, types::PyDict};
use rayon::ThreadPoolBuilder;
use verbs::{
    self, Progress, Watch,
    failure::{Done, Failure},
    output::{Array, Figure},
};

use crate::toml::key_at;

/// How often signals are looked for, and progress is shown.
const TICK: Duration = Duration::from_millis(50);
/// How long a call that gives nothing when it is stopped may take to end.
const PATIENCE: Duration = Duration::from_millis(100);
/// Calls that are shorter show no progress.
const SHORT: Duration = Duration::from_millis(500);

/// What a command found.
#[derive(Default)]
pub struct Found {
    /// Text, JSON and figures.
    pub common: verbs::Found,
    /// A report.
    pub page: String,
    /// Arrays of paths.
    pub paths: Vec<Array>,
    /// Arrays of statistics.
    pub statistics: Vec<Array>,
    /// Reasons why paths were left to the processor.
    pub left: Vec<String>,
}

/// Does work on a pool of its own, so that a process that forks later has no threads that hang.
/// Ctrl-C stops it: what is done is returned, or `KeyboardInterrupt` is raised if there is none.
/// Other errors, of `show` or of a handler of signals, stop it and are raised.
pub fn watched<'py>(
    py: Python<'py>,
    text: &str,
    threads: Option<usize>,
    show: Option<Py<PyAny>>,
    gives_what_is_done: bool,
    work: impl FnOnce(&Watch) -> Done<Found> + Send + 'static,
) -> PyResult<Bound<'py, PyDict>> {
    let begun = Instant::now();
    let under_way = Arc::new(Work(Mutex::new((String::new(), 0, 0, begun))));
    let watch = Watch { progress: Arc::clone(&under_way) as _, stop: Stop::default() };
    let (send, receive) = mpsc::channel();
    let receive = Mutex::new(receive);
    let own = watch.clone();
    let worker = thread::spawn(move || {
        let pool = ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
        let found = match pool {
            Ok(pool) => pool.install(|| work(&own)),
            Err(error) => Err(Failure::Run(error.to_string())),
        };
        // Nobody waits after a second Ctrl-C.
        let _ = send.send(found);
    });
    let shown = |words: &str| match show.as_ref().filter(|_| begun.elapsed() > SHORT) {
        Some(show) => show.call1(py, (words,)).map(drop),
        None => Ok(()),
    };
    let mut interrupted: Option<(PyErr, Instant)> = None;
    let found = loop {
        match py.detach(|| receive.lock().ok().map(|receive| receive.recv_timeout(TICK))) {
            Some(Ok(found)) => break found,
            None | Some(Err(RecvTimeoutError::Disconnected)) => {
                let _ = worker.join();
                break Err(Failure::Run("the computation broke off: please report this".into()));
            }
            Some(Err(RecvTimeoutError::Timeout)) => {}
        }
        // A signal is raised where Python code runs next, which may be within `show`.
        match (py.check_signals().and_then(|()| shown(&under_way.words(begun))), &interrupted) {
            (Err(error), None) if error.is_instance_of::<PyKeyboardInterrupt>(py) => {
                watch.stop.now();
                interrupted = Some((error, Instant::now()));
            }
            (Err(error), _) => {
                watch.stop.now();
                return Err(error);
            }
            (Ok(()), Some((_, at))) if !gives_what_is_done && at.elapsed() > PATIENCE => {
                return Err(PyKeyboardInterrupt::new_err(()));
            }
            _ => {}
        }
    };
    match shown("") {
        Err(error) if error.is_instance_of::<PyKeyboardInterrupt>(py) => {
            interrupted.get_or_insert((error, Instant::now()));
        }
        shown => shown?,
    }
    match (found, interrupted) {
        (Ok(found), interrupted) => {
            let result = dictionary(py, found)?;
            result.set_item("interrupted", interrupted.is_some())?;
            Ok(result)
        }
        (Err(_), Some((error, _))) => Err(error),
        (Err(failure), None) => Err(raised(py, text, failure)),
    }
}

/// What is under way: its name, its path-steps, those that are done, and since when.
struct Work(Mutex<(String, u64, u64, Instant)>);

impl Work {
    fn change(&self, change: impl FnOnce(&mut (String, u64, u64, Instant))) {
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner));
    }

    /// A line about it.
    fn words(&self, begun: Instant) -> String {
        let (what, all, done, since) =
            self.0.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let seconds = begun.elapsed().as_secs();
        if all == 0 {
            return format!("{seconds} s  {what}");
        }
        let part = done as f64 / all as f64;
        let left = since.elapsed().as_secs_f64() * (1.0 / part - 1.0);
        format!("{seconds} s  {:.0} % {what}, {left:.0} s left", 100.0 * part)
    }
}

impl Progress for Work {
    fn begin(&self, what: &str, path_steps: u64) {
        self.change(|work| *work = (what.to_owned(), path_steps, 0, Instant::now()));
    }

    fn advance(&self, path_steps: u64) {
        self.change(|work| work.2 += path_steps);
    }

    fn message(&self, words: &str) {
        self.change(|work| work.0 = words.to_owned());
    }

    fn say(&self, words: &str) {
        eprintln!("{words}");
    }
}

fn dictionary(py: Python<'_>, found: Found) -> PyResult<Bound<'_, PyDict>> {
    let result = PyDict::new(py);
    let arrays = |all: Vec<Array>| -> PyResult<Bound<'_, PyDict>> {
        let arrays = PyDict::new(py);
        for (name, shape, values) in all {
            // The numbers stay where they are.
            arrays.set_item(name, PyArray1::from_vec(py, values).reshape(shape)?)?;
        }
        Ok(arrays)
    };
    let Found { common, page, paths, statistics, left } = found;
    let verbs::Found { text, json, figures, .. } = common;
    let figure = |one: Figure| (one.file, one.svg, one.caption, one.name);
    let figures: Vec<_> = figures.into_iter().map(figure).collect();
    result.set_item("text", text)?;
    result.set_item("json", json.to_string())?;
    result.set_item("figures", figures)?;
    result.set_item("page", page)?;
    result.set_item("paths", arrays(paths)?)?;
    result.set_item("statistics", arrays(statistics)?)?;
    result.set_item("left", left)?;
    Ok(result)
}

/// The exception of a failure, with its place in the text.
pub fn raised(py: Python<'_>, text: &str, failure: Failure) -> PyErr {
    let error = |name, arguments: (String, Option<String>, Option<usize>, Option<usize>)| {
        let class = py.import("casimir._errors").and_then(|module| module.getattr(name));
        class.and_then(|class| class.call1(arguments)).map_or_else(|error| error, PyErr::from_value)
    };
    match failure {
        Failure::Scene(wrong) => {
            let message = wrong.to_string();
            let Some(place) = wrong.place else {
                return error("SceneError", (message, None, None, None));
            };
            let before = &text[..place.start.min(text.len())];
            let line = before.matches('\n').count() + 1;
            let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
            error("SceneError", (message, key_at(text, &place), Some(line), Some(column)))
        }
        Failure::Usage(message) => error("SceneError", (message, None, None, None)),
        Failure::Run(message) => error("RunError", (message, None, None, None)),
        Failure::Stopped(message) => PyKeyboardInterrupt::new_err(message),
    }
}
