//! A system with its damping, initial value and schemes, behind one trait for compiled systems and
//! those that are known at run time.

mod at_run_time;
mod damping;
mod formulas;
mod lattice;
mod project;

use std::sync::Arc;

use casimir::{
    analysis::facts::{Bath, Kept, fastest},
    formula::Names,
    mc::{Expect, Friction, Problem},
    schemes::{BuiltIn, Method, SchemeError},
    systems::run_time::System,
};

use crate::scene::{Further, MOST_COMPONENTS, Observable, Read, Reading};

pub use project::PROJECT;

/// More noises are too many to be compared with a bath one by one.
const MOST_NOISES: usize = 100;

/// A system with its damping and initial value.
pub trait Model: Send + Sync {
    /// The problem with its friction, and the laws that it obeys.
    fn problem(&self) -> Problem<'_>;

    /// A scheme for it.
    ///
    /// # Errors
    /// Why the scheme is not for the system.
    fn scheme(&self, scheme: BuiltIn) -> Result<Arc<dyn Method + '_>, SchemeError>;

    /// Expectations for which everything is chosen; `None` if they are computed by levels of random
    /// points.
    fn expect(&self) -> Option<Expect<'_>>;

    /// The system, for what is asked of any.
    fn system(&self) -> &dyn System;

    /// The scheme that `auto` takes, and why.
    fn recommended(&self) -> (&'static str, String) {
        let system = self.system();
        let areas = !system.description().noises_commute;
        Kept::of(&self.problem(), system, areas).scheme(system)
    }

    /// Friction on some components.
    fn friction(&self) -> &[Friction];

    /// The rates of the components, if they are constant in time.
    fn constant_rates(&self) -> Option<Vec<f64>> {
        let problem = self.problem();
        let rates = |t: f64| -> Vec<f64> {
            let of_all = problem.damping.rate(t);
            let friction = Friction::rates(self.friction(), t, problem.y0.len());
            friction.iter().map(|rate| rate + of_all).collect()
        };
        let first = rates(0.0);
        let constant = [0.37, 1.0].iter().all(|part| rates(part * problem.t_end) == first);
        constant.then_some(first)
    }

    /// What damping and noise do to the Gibbs measure, if the rates of damping are constant and the
    /// system is small.
    fn bath(&self) -> Option<Bath> {
        let (system, y0) = (self.system(), self.problem().y0);
        let description = system.description();
        let few = y0.len() <= MOST_COMPONENTS && description.noises <= MOST_NOISES;
        let small = few && !description.depends_on_time;
        Some(Bath::of(system, &y0, &self.constant_rates().filter(|_| small)?))
    }

    /// What the system is, as far as a run has to know; nothing of a system of the project.
    fn known(&self) -> Known {
        Known::default()
    }

    /// The rate of the fastest motion at the initial value, in radians per time; zero if it is not
    /// known.
    fn fastest(&self) -> f64 {
        fastest(self.system(), &self.problem().y0)
    }
}

/// What is found within milliseconds.
#[derive(Clone, Default)]
pub struct Known {
    /// The equation that was understood, component by component.
    pub equations: Vec<String>,
    /// Casimirs and the law of the energy.
    pub laws: Vec<String>,
    /// What is wrong.
    pub mistake: Option<String>,
}

impl Known {
    /// The equation as lines; nothing of a system of the project.
    pub fn equation(&self) -> String {
        match self.equations[..] {
            [] => String::new(),
            _ => format!("The equation as it was understood\n  {}\n", self.equations.join("\n  ")),
        }
    }

    /// Equation and laws, with the names of the components.
    pub fn text(&self, components: &[String]) -> String {
        let laws = self.laws.iter().map(|law| format!("{}\n", with_names(law, components)));
        self.equation() + &laws.collect::<String>()
    }
}

/// A model with the names of what it has.
pub struct Built {
    /// The model.
    pub model: Box<dyn Model>,
    /// The names of the components.
    pub components: Vec<String>,
    /// The sizes of a lattice; none of other systems.
    pub sizes: Vec<usize>,
    /// The names that formulas of observables may use.
    pub names: Names,
    /// H₀.
    pub energy: Further,
    /// Observables that come by themselves.
    pub quantities: Vec<Observable>,
}

/// The model of a scene.
pub fn build(reading: &Reading<'_>) -> Read<Built> {
    match &reading.file.system.name {
        Some(name) => project::build(reading, name),
        None => formulas::build(reading),
    }
}

/// A text in which `y1`, `y2`, … are the names of the components.
pub fn with_names(text: &str, components: &[String]) -> String {
    let mut named = String::new();
    let mut rest = text;
    while let Some(at) = rest.find('y') {
        let (before, found) = rest.split_at(at);
        let digits = found[1..].bytes().take_while(u8::is_ascii_digit).count();
        let begins = !before.ends_with(|c: char| c.is_alphanumeric() || c == '_');
        let name = found[1..=digits].parse().ok().filter(|n: &usize| begins && *n > 0);
        named += before;
        match name.and_then(|number| components.get(number - 1)) {
            Some(name) => named += name,
            None => named += &found[..=digits],
        }
        rest = &found[1 + digits..];
    }
    named + rest
}

#[cfg(test)]
mod tests {
    use super::with_names;

    #[test]
    fn components_get_their_names() {
        let names = ["M1".to_owned(), "G".to_owned()];
        let text = "0.5 y1² + y1 y2, ‖y‖, y3, any2, B(y)";
        assert_eq!(with_names(text, &names), "0.5 M1² + M1 G, ‖y‖, y3, any2, B(y)");
    }
}
