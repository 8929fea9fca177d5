//! **What is computed of [scenes], and how it is shown.**
//!
//! ```
//! use scenes::{Changes, Scene, Source};
//! use verbs::{Watch, expect};
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
//! let found = expect(&scene, None, &Watch::new(())).expect("an expectation");
//! assert!(found.unreached.is_none(), "{}", found.text);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Each verb has a file: [`run`](compute), [`expect`], [`equilibrium`], [`order`], [`compare`],
//! [`inspect`]. What they find is words, JSON and figures; [`output`] makes tables, pages and
//! arrays of runs.

pub mod citation;
mod compare;
pub mod doctor;
mod expect;
pub mod failure;
mod inspect;
mod order;
pub mod output;
mod referee;
mod run;
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

use casimir::{mc::parts::Stop, schemes::BuiltIn, systems::Linearity};
use serde::Serialize;
use serde_json::{Value, json};

pub use compare::compare;
pub use expect::expect;
pub use inspect::inspect;
pub use order::order;
pub use referee::{Measure, judge, single_steps, solver_noise};
pub use run::{Outcomes, Results, compute, ready, settle};
pub use stationary::equilibrium;

use crate::{
    failure::{Done, Failure},
    output::{Figure, distinct},
};
use scenes::{AUTO, Scene};

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
        warnings: impl IntoIterator<Item = String>,
        text: &str,
        mut json: Value,
        figures: Vec<Figure>,
    ) -> Self {
        json["title"] = json!(scene.title);
        let mistake = scene.model.known().mistake;
        let text = lines_of(&mistake) + text;
        Self::new(mistake.into_iter().chain(warnings), text, json, figures)
    }

    /// Result whose `warnings` are a list in `json`.
    fn new(
        warnings: impl IntoIterator<Item = String>,
        text: String,
        mut json: Value,
        mut figures: Vec<Figure>,
    ) -> Self {
        distinct(figures.iter_mut());
        json["warnings"] = warnings.into_iter().collect();
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
}

/// Time after which the progress is reported, where no bar shows it.
const SOON: Duration = Duration::from_secs(8);
/// Time after which the half-width reached so far is reported.
const PATIENCE: Duration = Duration::from_secs(60);

impl Watch {
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
pub fn lines_of<'a>(warnings: impl IntoIterator<Item = &'a String>) -> String {
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
