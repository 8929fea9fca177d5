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
//! let source = Source { name: "oscillator.toml".into(), text: text.into(), states: None };
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
pub mod failure;
mod fit;
mod inspect;
mod large;
mod order;
pub mod output;
mod referee;
mod run;
mod slopes;
mod stationary;

use std::{
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicU64, Ordering},
        mpsc::{RecvTimeoutError, channel},
    },
    thread,
    time::{Duration, Instant},
};

use casimir::{
    mc::{
        Checkpoint,
        parts::{Job, Stop},
    },
    schemes::BuiltIn,
    stats::Warning,
    systems::Linearity,
};
use schemars::{JsonSchema, Schema, schema_for};
use serde::{Serialize, de::DeserializeOwned};
use serde_json::{Value, json};

pub use compare::Compare;
pub use expect::Expect;
pub use fit::Fit;
pub use inspect::Inspect;
pub use order::Order;
pub use referee::{Measure, judge, single_steps, solver_noise};
pub use run::{Outcomes, Results, compute, ready, settle};
pub use stationary::{Equilibrium, Lyapunov};

use crate::{
    failure::{Done, Failure},
    output::{Figure, distinct},
};
use scenes::{AUTO, Changes, Scene};

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
    fn compute(&self, scene: &Scene, store: &Store, watch: &Watch) -> Done<Found>;
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
#[derive(Default)]
pub enum Store {
    /// Nowhere.
    #[default]
    Nothing,
    /// With a job, for [`Stores::Measurements`].
    Measurements(Arc<Job>),
    /// In a file, for [`Stores::Samples`].
    Samples(Checkpoint),
}

impl Store {
    fn job(&self) -> Option<&Arc<Job>> {
        if let Self::Measurements(job) = self { Some(job) } else { None }
    }

    fn samples(&self) -> Option<&Checkpoint> {
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

        /// Computes a verb by its name, with options as a JSON object. Nothing is stored.
        ///
        /// # Errors
        /// No such verb or option, or those of [`Verb::compute`].
        pub fn call(verb: &str, options: &str, scene: &Scene, watch: &Watch) -> Done<Found> {
            let wrong = |error| Failure::Usage(format!("{verb}: {error}"));
            match verb {
                $($verb::NAME => serde_json::from_str::<$verb>(options)
                    .map_err(wrong)?
                    .compute(scene, &Store::Nothing, watch),)+
                _ => Err(Failure::Usage(format!("no verb `{verb}`"))),
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
        let mistake = scene.model.known().mistake.map(Warning::new);
        let text = lines_of(&mistake) + text;
        Self::new(mistake.into_iter().chain(warnings), text, json, figures)
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

/// An estimate for programs with its interval.
fn with_interval(estimate: &impl Serialize, (lo, hi): (f64, f64), half_width: f64) -> Value {
    let mut json = json!(estimate);
    for (key, value) in [("lo", lo), ("hi", hi), ("half_width", half_width)] {
        json[key] = value.into();
    }
    json
}

/// Shows the progress of work; by default nothing is shown.
pub trait Progress: Send + Sync {
    /// Begins work of so long, in path-steps; zero if their number is not known.
    fn begin(&self, _what: &str, _path_steps: u64) {}

    /// Adds path-steps that are done.
    fn advance(&self, _path_steps: u64) {}

    /// Shows the state of the work in words.
    fn message(&self, _words: &str) {}

    /// Ends the work.
    fn end(&self) {}

    /// Whether somebody sees the progress. If not, long work is reported in words.
    fn is_seen(&self) -> bool {
        false
    }

    /// Says a line.
    fn say(&self, _words: &str) {}
}

/// Shows nothing.
impl Progress for () {}

/// Progress of a verb, and the request that ends it early.
#[derive(Clone)]
pub struct Watch {
    /// Shows the work that is under way.
    pub progress: Arc<dyn Progress>,
    /// Request to end early.
    pub stop: Stop,
}

impl Watch {
    /// Watch that shows `progress`; nothing has asked for the end.
    pub fn new(progress: impl Progress + 'static) -> Self {
        Self { progress: Arc::new(progress), stop: Stop::default() }
    }

    /// Does work to an accuracy. `work` reports its half-width so far and the part of its
    /// path-steps that is done. After a minute, and at the end, an accuracy that is not reached is
    /// reported, with the time that it takes.
    fn until<R>(&self, what: &str, accuracy: f64, work: impl FnOnce(&dyn Fn(f64, f64)) -> R) -> R {
        let (start, last) = (Instant::now(), Mutex::new((f64::INFINITY, 0.0)));
        let now = || start.elapsed().as_secs_f64();
        let last = || last.lock().unwrap_or_else(PoisonError::into_inner);
        let told = |half_width: f64, done: f64| {
            *last() = (half_width, now() / done);
            let left = now() * (1.0 / done - 1.0);
            self.progress.message(&format!(
                "±{half_width:.1e} so far, ±{accuracy:.1e} wanted, about {left:.0} s left"
            ));
        };
        let say = || {
            let ((half_width, whole), since) = (*last(), now());
            let so_far = match half_width.is_finite() {
                _ if half_width <= accuracy => return,
                true => {
                    let more = (whole - since).max(1.0) / 60.0;
                    format!("±{half_width:.1e} so far, about {more:.1} more")
                }
                false if since < PATIENCE.as_secs_f64() => return,
                false => "no estimate yet".into(),
            };
            let since = since / 60.0;
            let words = format!("±{accuracy:e} is not reached in {since:.1} minutes: {so_far}");
            self.progress.say(&words);
        };
        let result = watched(PATIENCE, say, || self.under(what, 0, |_| work(&told)));
        say();
        result
    }

    /// Does work of about `path_steps` path-steps, zero if that is not known; `work` tells how many
    /// more are done. Where nobody sees the progress of long work, it is reported once.
    pub fn under<R>(
        &self,
        what: &str,
        path_steps: u64,
        work: impl FnOnce(&(dyn Fn(u64) + Sync)) -> R,
    ) -> R {
        let (start, done, progress) = (Instant::now(), AtomicU64::new(0), &*self.progress);
        progress.begin(what, path_steps);
        let say = || {
            let since = start.elapsed().as_secs_f64();
            let part = path_steps as f64 / done.load(Ordering::Relaxed) as f64;
            let left = since * (part - 1.0);
            let known = left.is_finite().then(|| format!(", about {left:.0} s left"));
            if !progress.is_seen() {
                progress.say(&format!("{what}: {since:.0} s so far{}", known.unwrap_or_default()));
            }
        };
        let advance = |more| {
            done.fetch_add(more, Ordering::Relaxed);
            progress.advance(more);
        };
        let result = watched(SOON, say, || work(&advance));
        progress.end();
        result
    }

    /// Refuses to go on if the end was asked for.
    fn check(&self) -> Done {
        if self.stop.is_asked() {
            Err(Failure::Stopped("nothing is complete".into()))
        } else {
            Ok(())
        }
    }
}

/// Time after which the progress is reported, where no bar shows it.
const SOON: Duration = Duration::from_secs(8);
/// Time after which the half-width reached so far is reported.
const PATIENCE: Duration = Duration::from_secs(60);

/// Does work, and calls `say` if that takes longer than `patience`.
fn watched<R>(patience: Duration, say: impl Fn() + Sync, work: impl FnOnce() -> R) -> R {
    thread::scope(|scope| {
        let ((working, ended), say) = (channel::<()>(), &say);
        scope.spawn(move || {
            if ended.recv_timeout(patience) == Err(RecvTimeoutError::Timeout) {
                say();
            }
        });
        let result = work();
        drop(working);
        result
    })
}

/// A scheme, and why it was chosen if that was left to the program, or what it loses over long
/// times: what `plan` settles, so that no part inspects the system.
pub type Settled = (String, Option<String>);

/// The scheme of a scene.
pub fn scheme(scene: &Scene) -> Settled {
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

/// Warnings as lines.
pub fn lines_of<'a>(warnings: impl IntoIterator<Item = &'a Warning>) -> String {
    warnings.into_iter().map(|warning| format!("warning: {warning}\n")).collect()
}

/// Steps of the coarsest level: an eighth of a unit of time or shorter. Finer levels follow from
/// what is measured.
fn coarsest_steps(until: f64) -> u64 {
    let most = f64::from(1u32 << 24);
    ((8.0 * until).ceil().clamp(4.0, most) as u64).next_power_of_two()
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicU32;

    use super::*;

    #[test]
    fn long_work_is_spoken_of_once() {
        for (patience, expected) in [(Duration::from_millis(1), 1), (PATIENCE, 0)] {
            let said = AtomicU32::new(0);
            let say = || _ = said.fetch_add(1, Ordering::Relaxed);
            watched(patience, say, || thread::sleep(Duration::from_millis(200)));
            assert_eq!(said.into_inner(), expected);
        }
    }
}
