//! The compiled half of the Python package `casimir`: scenes as texts go in, results as arrays, JSON
//! and figures come out. What Python sees of it is in `casimir/*.py`.

mod calls;
mod referee;
mod toml;

use std::{
    ffi::OsString,
    path::{Path, PathBuf},
};

use ::scenes::{Changes, Scene, Source, Sweep, gallery};
use casimir::mc::parts::{Job, JobError, Share, remove};
use numpy::PyReadonlyArray2;
use pyo3::{exceptions::PyValueError, prelude::*, types::PyDict};
use serde_json::{Value, json};
use verbs::{
    self, Settled, Watch,
    failure::{Done, Failure},
    output::arrays,
};

use calls::{Found, watched};

/// A scene as Python has it: text, name, and initial states [path, component].
#[derive(FromPyObject)]
struct Given<'py> {
    text: String,
    name: String,
    states: Option<PyReadonlyArray2<'py, f64>>,
}

impl Given<'_> {
    fn source(&self) -> Source {
        let rows = |states: &PyReadonlyArray2<'_, f64>| {
            states.as_array().rows().into_iter().map(|row| row.to_vec()).collect()
        };
        let states = self.states.as_ref().map(|states| std::sync::Arc::new(rows(states)));
        let (name, text) = (self.name.clone(), self.text.clone());
        Source { name, text, states, device: None }
    }
}

/// How a call is made: threads, what shows progress, and a folder for unfinished work.
#[derive(FromPyObject)]
struct How {
    threads: Option<usize>,
    show: Option<Py<PyAny>>,
    folder: Option<PathBuf>,
    gpu: bool,
}

/// What a scene has, as JSON.
#[pyfunction]
fn check(py: Python<'_>, given: Given<'_>) -> PyResult<String> {
    let source = given.source();
    let found = py.detach(|| -> Done<Value> {
        let sweep = Sweep::new(&source, &Changes::default())?;
        let scene = sweep.scene();
        let names = |all: &[::scenes::Observable]| {
            all.iter().map(|one| one.name.clone()).collect::<Vec<_>>()
        };
        let varied = sweep.varied.iter().map(|one| (one.name.clone(), json!(one.values)));
        Ok(json!({
            "title": scene.title,
            "components": scene.components,
            "observables": names(&scene.observables),
            "expected": names(&scene.expected),
            "sweep": varied.collect::<Value>(),
            "paths": scene.settings.paths,
            "steps": scene.settings.steps,
            "until": scene.settings.until,
            "seed": scene.settings.key.seed,
        }))
    });
    found.map(|found| found.to_string()).map_err(|failure| calls::raised(py, &given.text, failure))
}

/// The schemes of a scene at every combination, as JSON.
#[pyfunction]
fn settle(py: Python<'_>, given: Given<'_>, independent: bool) -> PyResult<String> {
    let (source, changes) = (given.source(), Changes { independent, ..Changes::default() });
    let found = py.detach(|| -> Done<String> {
        let sweep = Sweep::new(&source, &changes)?;
        Ok(serde_json::to_string(&verbs::settle(&sweep))?)
    });
    found.map_err(|failure| calls::raised(py, &given.text, failure))
}

/// A part of a run: its number and that of all parts, or none of all to merge them; and the schemes
/// that were settled for all.
type Part = ((u64, u64), String);

/// The job of a run: here, with checkpoints in a folder, one part, or merging.
fn job(sweep: &Sweep, folder: Option<&Path>, part: Option<&Part>, watch: &Watch) -> Done<Job> {
    let program = |settled: &[Settled]| {
        let schemes = settled.iter().map(|(scheme, _)| format!("scheme = {scheme}\n"));
        verbs::program(sweep.scene(), &schemes.collect::<String>())
    };
    let job = match (folder, part) {
        (None, _) => Job::here().giving_what_is_done(),
        (Some(folder), None) => {
            Job::part(folder, Share::WHOLE, program(&[]))?.giving_what_is_done()
        }
        (Some(folder), Some(((number, of), settled))) => {
            let program = program(&serde_json::from_str::<Vec<Settled>>(settled)?);
            match of {
                0 => Job::merge(folder, program)?,
                _ => Job::part(folder, Share::new(*number, *of)?, program)?,
            }
        }
    };
    Ok(job.stopped_by(&watch.stop))
}

/// Runs a scene, at every combination of what is varied: all of it, a part, or the merging of parts.
#[pyfunction]
#[pyo3(signature = (given, independent, how, part=None))]
fn run<'py>(
    py: Python<'py>,
    given: Given<'py>,
    independent: bool,
    how: How,
    part: Option<Part>,
) -> PyResult<Bound<'py, PyDict>> {
    let (source, changes) = (given.source(), Changes { independent, ..Changes::default() });
    watched(py, &given.text, how.threads, how.show, part.is_none(), move |watch| {
        let device = how.gpu.then(casimir_cli::card).transpose().map_err(Failure::Run)?;
        let sweep = Sweep::new(&Source { device: device.clone(), ..source }, &changes)?;
        let settled = match &part {
            Some((_, settled)) => serde_json::from_str(settled)?,
            None => verbs::settle(&sweep),
        };
        let ready = verbs::ready(&sweep, settled)?;
        let job = job(&sweep, how.folder.as_deref(), part.as_ref(), watch)?;
        let mut found = verbs::compute(&sweep, ready, &job, watch)?;
        match job.finish() {
            Ok(()) | Err(JobError::Stopped) if watch.stop.is_asked() => {}
            finished => finished?,
        }
        if watch.stop.is_asked() && (part.is_some() || found.are_empty()) {
            return Err(Failure::Stopped("before the first path".into()));
        }
        if part.as_ref().is_some_and(|((_, of), _)| *of > 0) {
            return Ok(Found::default());
        }
        if let (Some(folder), None, false) = (&how.folder, &part, watch.stop.is_asked()) {
            remove(folder, Share::WHOLE)?;
        }
        found.check()?;
        let (json, figures) = (found.json(), found.figures());
        let (text, page) = (found.text(), found.page(&figures));
        let figures = figures.into_iter().flat_map(|(_, figures)| figures).collect();
        let [paths, statistics] = arrays(&mut found);
        let common = verbs::Found { text, json, figures, unreached: None };
        let left = device.iter().flat_map(|device| device.refused()).collect();
        Ok(Found { common, page, paths, statistics, left })
    })
}

/// Computes a verb of one scene, with options as JSON.
#[pyfunction]
fn call<'py>(
    py: Python<'py>,
    verb: String,
    given: Given<'py>,
    options: String,
    how: How,
) -> PyResult<Bound<'py, PyDict>> {
    let (source, gives_what_is_done) = (given.source(), verbs::is_of_samples(&verb));
    watched(py, &given.text, how.threads, how.show, gives_what_is_done, move |watch| {
        let scene = Scene::new(source, &Changes::default())?;
        let common = verbs::call(&verb, &options, &scene, how.folder.as_deref(), watch)?;
        Ok(Found { common, ..Found::default() })
    })
}

/// Runs the program with the arguments of a command line; returns its exit code.
#[pyfunction]
fn main(py: Python<'_>, program: PathBuf, arguments: Vec<OsString>) -> u8 {
    py.detach(|| casimir_cli::run(program, arguments))
}

/// Facts about this machine, a self-test, and whether it holds.
#[pyfunction]
fn doctor(py: Python<'_>) -> PyResult<(String, bool)> {
    let found = py.detach(|| verbs::doctor::self_test(verbs::doctor::EXPECTED));
    let (text, holds) = found.map_err(|failure| calls::raised(py, "", failure))?;
    Ok((verbs::doctor::facts(option_env!("CASIMIR_COMMIT")) + &text, holds))
}

/// Student's quantile of the 95 % interval.
#[pyfunction]
fn student(degrees: f64) -> f64 {
    casimir::stats::two_sided(casimir::stats::CONFIDENCE, Some(degrees))
}

/// BibTeX of what a result used, given its JSON, or of all that may be cited.
#[pyfunction]
fn citation(result: Option<&str>) -> PyResult<String> {
    let result = result.map(serde_json::from_str::<Value>).transpose();
    let result = result.map_err(|error| PyValueError::new_err(error.to_string()))?;
    Ok(verbs::citation::bibtex(result.as_ref()))
}

/// Names of the scenes of the gallery.
#[pyfunction]
#[pyo3(name = "scenes")]
fn gallery_scenes() -> Vec<&'static str> {
    gallery::GALLERY.iter().map(|(name, _)| *name).collect()
}

/// The text of a scene of the gallery.
#[pyfunction]
fn scene(name: &str) -> PyResult<&'static str> {
    gallery::scene(name).map_err(PyValueError::new_err)
}

/// The JSON schema of scenes.
#[pyfunction]
fn schema() -> PyResult<String> {
    serde_json::to_string(&::scenes::schema())
        .map_err(|error| PyValueError::new_err(error.to_string()))
}

/// The compiled half of the package.
#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_function(wrap_pyfunction!(check, module)?)?;
    module.add_function(wrap_pyfunction!(run, module)?)?;
    module.add_function(wrap_pyfunction!(settle, module)?)?;
    module.add_function(wrap_pyfunction!(call, module)?)?;
    module.add_function(wrap_pyfunction!(main, module)?)?;
    module.add_function(wrap_pyfunction!(doctor, module)?)?;
    module.add_function(wrap_pyfunction!(student, module)?)?;
    module.add_function(wrap_pyfunction!(citation, module)?)?;
    module.add_function(wrap_pyfunction!(gallery_scenes, module)?)?;
    module.add_function(wrap_pyfunction!(scene, module)?)?;
    module.add_function(wrap_pyfunction!(schema, module)?)?;
    module.add_function(wrap_pyfunction!(referee::solver_noise, module)?)?;
    module.add_function(wrap_pyfunction!(referee::single_steps, module)?)?;
    module.add_function(wrap_pyfunction!(referee::judge, module)?)?;
    module.add_function(wrap_pyfunction!(toml::changed, module)?)?;
    module.add_function(wrap_pyfunction!(toml::as_json, module)?)
}
