//! What is computed of scenes. Each command has a file; `output` writes what it finds.

mod compare;
mod expect;
mod inspect;
mod order;
mod referee;
mod run;
mod stationary;

use std::time::Duration;

use casimir::{mc::parts::Stop, schemes::BuiltIn, systems::Linearity};
pub use indicatif::ProgressBar;
use indicatif::ProgressStyle;
use serde_json::Value;

pub use compare::compare;
pub use expect::expect;
pub use inspect::inspect;
pub use order::order;
pub use referee::{Claims, Measure, SINGLE_STATES, judge, single_steps, solver_noise};
pub use run::{Outcomes, Ready, Results, compute, ready};
pub use stationary::{Asked, equilibrium};

use crate::{
    failure::{Done, Failure},
    output::Drawn,
    scene::{AUTO, Scene},
};

/// What a command found.
#[derive(Default)]
pub struct Found {
    /// In words.
    pub text: String,
    /// For programs.
    pub json: Value,
    /// In figures.
    pub figures: Vec<Drawn>,
}

impl Found {
    /// With the warnings among the words as a list for programs.
    fn new(text: String, mut json: Value, figures: Vec<Drawn>) -> Self {
        json["warnings"] = text.lines().filter_map(|line| line.strip_prefix(WARNING)).collect();
        Self { text, json, figures }
    }
}

/// How a command tells how far it is, and what ends it early.
#[derive(Clone)]
pub struct Watch {
    /// The work that is under way.
    pub bar: ProgressBar,
    /// Whether the end was asked for.
    pub stop: Stop,
}

impl Watch {
    /// Does work of about so many path-steps, zero if that is not known, under the bar, which shows
    /// nothing where the output is no terminal.
    fn under<R>(&self, what: String, path_steps: u64, work: impl FnOnce() -> R) -> R {
        let template = match path_steps {
            0 => "{elapsed:>4} {spinner} {msg}",
            _ => "{elapsed:>4} [{bar:28}] {percent:>3}% {msg}, {eta} left",
        };
        let style = ProgressStyle::with_template(template).expect("the template is valid");
        let bar = &self.bar;
        bar.set_style(style.progress_chars("=> "));
        bar.set_length(path_steps);
        bar.reset();
        bar.set_message(what);
        if !bar.is_hidden() {
            bar.enable_steady_tick(Duration::from_millis(200));
        }
        let result = work();
        bar.finish_and_clear();
        result
    }

    /// Refuses to go on if the end was asked for.
    fn check(&self) -> Done {
        match self.stop.is_asked() {
            true => Err(Failure::Stopped("nothing is complete".into())),
            false => Ok(()),
        }
    }
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

/// What lines of warnings begin with.
const WARNING: &str = "warning: ";

/// Warnings as lines.
pub fn warnings<'a>(words: impl IntoIterator<Item = &'a String>) -> String {
    words.into_iter().map(|words| format!("{WARNING}{words}\n")).collect()
}

/// Steps of the coarsest level: an eighth of a unit of time or shorter. Finer levels follow from
/// what is measured.
fn coarsest_steps(until: f64) -> u64 {
    let most = f64::from(1u32 << 24);
    ((8.0 * until).ceil().clamp(4.0, most) as u64).next_power_of_two()
}
