//! **What is computed of [scenes], and how it is shown.**
//!
//! ```
//! use scenes::{Changes, Scene, Source};
//! use verbs::{Expect, Store, Verb, Watch};
//!
//! let text = r#"
//! [system]
//! state = ["q", "p"]
//! B = [["1"]]
//! H0 = "(q^2 + p^2)/2"
//! H = ["0.1*q"]
//! [run]
//! initial = [1, 0]
//! until = 1
//! steps = 64
//! [expect]
//! of = ["q^2"]
//! accuracy = 0.01
//! "#;
//! let source = Source::new("oscillator.toml", text);
//! let scene = Scene::new(source, &Changes::default())?;
//! let found = Expect::default().compute(&scene, &Store::Nothing, &Watch::new(()));
//! let found = found.expect("an expectation");
//! assert!(found.unreached.is_none(), "{}", found.text);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A [`Verb`] is declared once, in the file of its name: its options are arguments of the command
//! line, keys of JSON ([`options`], [`call`]) and keyword arguments of Python. It finds words, JSON
//! and figures. A [`run`](compute) is of a whole sweep, and [`output`] makes tables, pages and
//! arrays of it.

pub mod citation;
mod compare;
mod data;
pub mod doctor;
mod expect;
mod fit;
mod inspect;
mod order;
mod referee;
mod slopes;
mod stationary;

use std::{fmt::Display, fs, path::Path, sync::Arc};

use casimir::{
    mc::{
        Checkpoint, Observe, files,
        parts::{Job, JobError, Program, Share, remove},
    },
    stats::Warning,
};
use schemars::{Schema, schema_for};
use serde::de::DeserializeOwned;

pub use compare::Compare;
pub use expect::Expect;
pub use fit::Fit;
pub use inspect::Inspect;
pub use order::Order;
pub use referee::{Measure, judge, single_steps, solver_noise};
pub use runs::{
    Outcomes, Progress, Results, Settled, Watch, compute, failure, lines_of, output, ready, scheme,
    settle,
};
pub use stationary::{Equilibrium, Lyapunov};

use crate::{failure::refuse, output::distinct, prelude::*};
use scenes::Source;

/// Names that all verbs use.
mod prelude {
    pub use std::time::Instant;

    pub use casimir::schemes::BuiltIn;
    pub use schemars::JsonSchema;
    pub use serde::{Deserialize, Serialize};
    pub use serde_json::{Value, json};

    pub(crate) use crate::{
        Found, Store, Stores, Verb, Watch, coarsest_steps,
        failure::{Done, Failure},
        observed,
        output::Figure,
        refused, scheme,
    };
    pub use scenes::{AUTO, Changes, Count, Observable, Scene, SchemeAndSeed};
}

/// A verb, what is computed of one scene, with its options.
pub trait Verb: DeserializeOwned + JsonSchema {
    /// Name of the verb.
    const NAME: &'static str;
    /// Unfinished work that is stored.
    const STORES: Stores;
    /// Default of whether results are written to a folder.
    const WRITES: bool = true;

    /// Changes of the scene.
    fn changes(&self) -> Changes;

    /// Options that stored work depends on, in lines `key = value`.
    fn meaning(&self) -> String {
        String::new()
    }

    /// Computes what is asked of a scene.
    ///
    /// # Errors
    /// [`Failure`]: the scene or an option is wrong, the work failed, or was stopped before there
    /// was a result.
    fn compute(&self, scene: &Scene, store: &Store<'_>, watch: &Watch) -> Done<Found>;
}

/// Unfinished work that a verb stores.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Stores {
    /// Nothing.
    Nothing,
    /// Measurements that are complete. A result needs all of them.
    Measurements,
    /// Samples, in a file of this name. Results are of the samples so far.
    Samples(&'static str),
}

/// Where unfinished work is stored.
#[derive(Clone, Copy)]
pub enum Store<'a> {
    /// Nowhere.
    Nothing,
    /// With a job, for [`Stores::Measurements`].
    Measurements(&'a Arc<Job>),
    /// In a file, for [`Stores::Samples`].
    Samples(&'a Checkpoint),
}

impl<'a> Store<'a> {
    fn job(self) -> Option<&'a Arc<Job>> {
        if let Self::Measurements(job) = self { Some(job) } else { None }
    }

    fn samples(self) -> Option<&'a Checkpoint> {
        if let Self::Samples(samples) = self { Some(samples) } else { None }
    }
}

/// The verbs.
macro_rules! verbs {
    ($($verb:ident),+) => {
        /// The options of a verb by its name, as a JSON schema.
        pub fn options(verb: &str) -> Option<Schema> {
            match verb {
                $($verb::NAME => Some(schema_for!($verb)),)+
                _ => None,
            }
        }

        /// Names of the verbs.
        pub const NAMES: &[&str] = &[$($verb::NAME),+];

        /// Computes a verb by its name, with options as a JSON object, and unfinished work in a
        /// `folder`, if there is one.
        ///
        /// # Errors
        /// No such verb or option, a folder that has other work, or those of [`Verb::compute`].
        pub fn call(
            verb: &str,
            options: &str,
            scene: &Scene,
            folder: Option<&Path>,
            watch: &Watch,
        ) -> Done<Found> {
            let wrong = |error| Failure::Usage(format!("{verb}: {error}"));
            match verb {
                $($verb::NAME => {
                    let verb = serde_json::from_str::<$verb>(options).map_err(wrong)?;
                    stored(&verb, scene, folder, watch)
                })+
                _ => refuse(format!("no verb `{verb}`")),
            }
        }

        /// Whether a verb has results when it is stopped early.
        pub fn is_of_samples(verb: &str) -> bool {
            match verb {
                $($verb::NAME => matches!($verb::STORES, Stores::Samples(_)),)+
                _ => false,
            }
        }
    };
}

verbs!(Inspect, Expect, Fit, Equilibrium, Lyapunov, Order, Compare);

/// This program and what it computes of a scene, as files for unfinished work name it: with further
/// lines of a command.
pub fn program(scene: &Scene, further: &str) -> Program {
    let (name, version) = ("casimir".into(), env!("CARGO_PKG_VERSION").into());
    Program { name, version, input: scene.meaning() + further }
}

/// Computes a verb that goes on from the unfinished work in a folder, and keeps its own there until
/// it is complete.
fn stored<V: Verb>(verb: &V, scene: &Scene, folder: Option<&Path>, watch: &Watch) -> Done<Found> {
    let Some(folder) = folder.filter(|_| V::STORES != Stores::Nothing) else {
        return verb.compute(scene, &Store::Nothing, watch);
    };
    let program = program(scene, &verb.meaning());
    if let Stores::Samples(file) = V::STORES {
        files::prepare(folder)?;
        let samples = Checkpoint::new(folder.join(file), program);
        samples.holds()?;
        return verb.compute(scene, &Store::Samples(&samples), watch);
    }
    let job = Arc::new(
        Job::part(folder, Share::WHOLE, program)?.stopped_by(&watch.stop).giving_what_is_done(),
    );
    let found = verb.compute(scene, &Store::Measurements(&job), watch);
    match Arc::into_inner(job).map_or(Ok(()), Job::finish) {
        Ok(()) | Err(JobError::Stopped) => {}
        Err(error) => return Err(error.into()),
    }
    if found.is_ok() {
        remove(folder, Share::WHOLE)?;
    }
    found
}

/// Result of a command.
#[derive(Default)]
pub struct Found {
    /// Result in words.
    pub text: String,
    /// Result as JSON for programs.
    pub json: Value,
    /// Figures of the result.
    pub figures: Vec<Figure>,
    /// Words for an accuracy that was not reached.
    pub unreached: Option<String>,
}

impl Found {
    /// Result for a scene, with its title and with the mistake that it has. `text` has the
    /// `warnings` in its own words.
    fn of(
        scene: &Scene,
        warnings: impl IntoIterator<Item = Warning>,
        text: &str,
        mut json: Value,
        figures: Vec<Figure>,
    ) -> Self {
        json["title"] = json!(scene.title);
        let known = Vec::from_iter(scene.model.known().warnings());
        let text = lines_of(&known) + text;
        Self::new(known.into_iter().chain(warnings), text, json, figures)
    }

    /// Result whose `warnings` are a list in `json`.
    fn new(
        warnings: impl IntoIterator<Item = Warning>,
        text: String,
        mut json: Value,
        mut figures: Vec<Figure>,
    ) -> Self {
        distinct(figures.iter_mut());
        json["warnings"] = json!(warnings.into_iter().collect::<Vec<_>>());
        Self { text, json, figures, unreached: None }
    }

    /// Marks estimates as unreached unless `reached`, with the wanted `accuracy` if there was one.
    fn to(mut self, reached: bool, accuracy: Option<f64>) -> Self {
        let wish = accuracy.map_or(String::new(), |wish| format!("±{wish:e} not reached, or "));
        self.unreached = (!reached).then(|| wish + "not to be believed");
        self
    }
}

/// The text of a file, which is `what` in words.
///
/// # Errors
/// [`Failure::Usage`] if it cannot be read.
pub fn source(what: &str, file: &Path) -> Done<Source> {
    let name = file.display().to_string();
    match fs::read_to_string(file) {
        Ok(text) => Ok(Source::new(name, text)),
        Err(error) => refuse(format!("cannot read the {what} {name}: {error}")),
    }
}

/// An error about a scene as a whole.
fn refused(scene: &Scene, message: impl Display) -> Failure {
    scene.source.error(None, message).into()
}

/// Observables, for what computes with them.
fn observed<'a>(all: impl IntoIterator<Item = &'a Observable>) -> Vec<&'a dyn Observe> {
    all.into_iter().map(|phi| phi as _).collect()
}

/// An estimate for programs with its interval.
fn with_interval(estimate: &impl Serialize, (lo, hi): (f64, f64), half_width: f64) -> Value {
    let mut json = json!(estimate);
    for (key, value) in [("lo", lo), ("hi", hi), ("half_width", half_width)] {
        json[key] = value.into();
    }
    json
}

/// Steps of the coarsest level: an eighth of a unit of time or shorter. Finer levels follow from
/// what is measured.
fn coarsest_steps(until: f64) -> u64 {
    ((8.0 * until).ceil().clamp(4.0, f64::from(1u32 << 24)) as u64).next_power_of_two()
}
