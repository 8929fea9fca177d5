//! A system with its damping, initial value and schemes, behind one trait for compiled systems and
//! those that are known at run time.

mod bath;
mod damping;
mod formulas;
mod large;
mod lattice;
mod matrices;
mod project;

use std::sync::{Arc, OnceLock};

use casimir::{
    expectation::Expect,
    formula::{FormulaSystem, Names},
    inspect::facts::{
        Bath, Conserved, DampingIntegral, Facts, Form, Span, fastest, is_divergence_free, span,
    },
    mc::{Friction, Initial, Problem, bind_at_run_time},
    schemes::{Baoab, BuiltIn, Method, SchemeError, SexpH, SplitH, run_time as run_time_schemes},
    stationary::Metropolis,
    stats::Warning,
    systems::{
        Damping, Linearity,
        run_time::{self, Description, System},
    },
};
use keys::*;

pub use large::Large;
pub use lattice::MANY_SITES;
pub use matrix::Grid;

pub use project::PROJECT;

use formulas::damped;

/// Largest numbers of components and of noises that are compared with a bath one by one.
const MAX_OF_BATH: usize = 64;
const MAX_NOISES: usize = 100;

/// A system with its damping and initial value.
pub trait Model: Send + Sync {
    /// The problem with its friction, and the laws that it obeys.
    fn problem(&self) -> Problem<'_>;

    /// A scheme for it.
    ///
    /// # Errors
    /// [`SchemeError`] with the reason why the scheme does not fit the system.
    fn scheme(&self, scheme: BuiltIn) -> Result<Arc<dyn Method + '_>, SchemeError>;

    /// Expectations for which everything is chosen; `None` if they are computed by levels of random
    /// points.
    fn expect(&self) -> Option<Expect<'_>> {
        None
    }

    /// The system, in the form that is common to all systems.
    fn system(&self) -> &dyn System;

    /// The scheme that `auto` takes, and why.
    fn recommended(&self) -> (&'static str, String) {
        let system = self.system();
        let areas = !system.description().noises_commute;
        Conserved::of(&self.problem(), system, areas).scheme(system)
    }

    /// Friction on some components.
    fn friction(&self) -> &[Friction] {
        self.problem().friction
    }

    /// The rates of the components, if they are constant in time.
    fn constant_rates(&self) -> Option<Vec<f64>> {
        let problem = self.problem();
        let rates = |t: f64| -> Vec<f64> {
            let of_all = problem.damping.rate(t);
            let friction = Friction::rates(problem.friction, t, problem.y0.len());
            friction.iter().map(|rate| rate + of_all).collect()
        };
        let first = rates(0.0);
        [0.37, 1.0].iter().all(|part| rates(part * problem.t_end) == first).then_some(first)
    }

    /// Effect of damping and noise on the Gibbs measure, if the rates of damping are constant and
    /// the system is small.
    fn bath(&self) -> Option<Bath> {
        let (system, y0) = (self.system(), self.problem().y0);
        let Description { plain, noises, depends_on_time, .. } = system.description();
        let few = y0.len() <= MAX_OF_BATH && *noises <= MAX_NOISES;
        let rates = self.constant_rates().filter(|_| few && !plain && !depends_on_time)?;
        Some(Bath::of(system, &y0, &rates))
    }

    /// The inverse temperature β of a law e^{−βH₀} that is stationary on leaves, and reached.
    ///
    /// # Errors
    /// The reason why there is none, in words.
    fn gibbs(&self) -> Result<f64, String> {
        let beta = self.bath().and_then(|bath| bath.beta);
        let beta = beta.ok_or("no exp(-H0/kT) is known to be stationary")?;
        // Flows keep the volume of leaves; β is of that of y.
        let (system, y0) = (self.system(), self.problem().y0);
        let constant = system.description().linearity == Linearity::Constant;
        if !constant && !is_divergence_free(system, &y0) {
            return Err("the volume of leaves is not that of y".into());
        }
        match span(system, &y0) {
            Some(Span { reached, leaf, .. }) if reached < leaf => {
                Err("its noises do not reach all of a leaf".into())
            }
            _ => Ok(beta),
        }
    }

    /// The sampler of e^{−βH₀} whose steps have no bias.
    ///
    /// # Errors
    /// The reason why there is none, in words.
    fn metropolis(&self) -> Result<Metropolis<'_>, String> {
        Err("the system is not of formulas".into())
    }

    /// Whether fields may jump where functions of the state have kinks.
    fn has_kinks(&self) -> bool {
        false
    }

    /// Facts about the system that a run needs; empty for a system of the project.
    fn known(&self) -> Known {
        Known::default()
    }

    /// The lattice whose paths are computed one after the other, each on all threads.
    fn large(&self) -> Option<&Large> {
        None
    }

    /// Values of the vorticity of a state on a grid of the sphere, of a fluid there.
    fn vorticity(&self, _state: &[f64], _grid: &Grid) -> Option<Vec<f64>> {
        None
    }

    /// The rate of the fastest motion at the initial value, in radians per time; zero if it is not
    /// known.
    fn fastest(&self) -> f64 {
        fastest(self.system(), &self.problem().y0)
    }
}

/// A problem whose system is known at run time.
struct AtRunTime {
    problem: run_time::Problem,
    friction: Vec<Friction>,
    /// Random initial values that are not those of the settings.
    initial: Option<Initial<'static>>,
    /// System of formulas; none for a lattice.
    formulas: Option<Arc<FormulaSystem>>,
    /// Remark on the equation.
    remark: Option<Warning>,
    /// Facts about the formulas, once they are found.
    facts: OnceLock<Facts>,
    /// The system that follows single Hamiltonians, once it is made.
    flows: OnceLock<FormulaSystem>,
}

impl AtRunTime {
    fn new(
        problem: run_time::Problem,
        friction: Vec<Friction>,
        formulas: Option<Arc<FormulaSystem>>,
    ) -> Self {
        let (facts, flows) = (OnceLock::new(), OnceLock::new());
        Self { problem, friction, initial: None, formulas, remark: None, facts, flows }
    }

    /// Facts about the formulas, such as Casimirs, found once. None for lattices, which are too
    /// large.
    fn facts(&self) -> Option<&Facts> {
        self.formulas.as_ref()?;
        Some(self.facts.get_or_init(|| Facts::of(&self.problem)))
    }
}

impl Model for AtRunTime {
    fn problem(&self) -> Problem<'_> {
        let mut problem = Problem::at_run_time(&self.problem);
        problem.initial.clone_from(&self.initial);
        if let Some(facts) = self.facts() {
            problem.laws = facts.laws(self.system());
        }
        problem.with_friction(&self.friction)
    }

    fn scheme(&self, scheme: BuiltIn) -> Result<Arc<dyn Method + '_>, SchemeError> {
        let (system, friction) = (self.system(), &self.friction[..]);
        let own = Friction::inside(friction);
        let has_own = !friction.is_empty() && !system.description().plain;
        let inside: Box<dyn run_time_schemes::Scheme> = match scheme {
            BuiltIn::Baoab if has_own => Box::new(Baoab::new(own)),
            BuiltIn::SplitH if has_own => Box::new(SplitH::of(system, own)),
            BuiltIn::SexpH if has_own => Box::new(SexpH::of(system, own)),
            _ => {
                let scheme = bind_at_run_time(system, scheme.at_run_time(system)?)?;
                return Ok(Friction::around(scheme, friction));
            }
        };
        bind_at_run_time(system, inside)
    }

    /// Recommends no scheme with Lévy areas: formulas and lattices use one only if it is named.
    fn recommended(&self) -> (&'static str, String) {
        let system = self.system();
        let (scheme, mut why) = Conserved::of(&self.problem(), system, false).scheme(system);
        let Description { parts, has_bath, .. } = system.description();
        if let (Err(reason), None, false) = (parts, &self.formulas, has_bath) {
            why += &format!("; split would not do: {reason}");
        }
        (scheme, why)
    }

    fn known(&self) -> Known {
        let (Some(facts), Some(system)) = (self.facts(), &self.formulas) else {
            return Known::default();
        };
        let (laws, plain) = (self.problem().laws, self.system().description().plain);
        let holds = |name: &str| laws.iter().any(|law| law.name == name);
        let form = |(k, form): (usize, &Form)| {
            let name = format!("C{k}");
            let broken = if holds(&name) { "" } else { ", which friction breaks" };
            let what = if plain { "Kept: " } else { "Casimir " };
            format!("{what}{name} = {}{broken}", form.formula())
        };
        let energy = facts.energy_law().filter(|_| holds("H0")).map(|degree| {
            match (facts.damped, self.friction.is_empty()) {
                (false, true) => "H0 is constant".into(),
                (_, true) => format!("H0 decays as exp(-{degree} ∫γ)"),
                _ => "H0 decays as each of its monomials".into(),
            }
        });
        let t_end = self.problem.t_end();
        let mistake = |one: &Friction| DampingIntegral::of(&*one.damping, t_end).mistake();
        Known {
            equations: system.equations(&damped(&self.problem, &self.friction)),
            laws: (1..).zip(&facts.casimirs).map(form).chain(energy).collect(),
            mistake: facts.mistake.clone().or_else(|| self.friction.iter().find_map(mistake)),
            remark: self.remark.clone(),
        }
    }

    fn metropolis(&self) -> Result<Metropolis<'_>, String> {
        let formulas = self.formulas.as_ref().ok_or("a lattice has no such flows")?;
        let beta = self.gibbs()?;
        let flows = self.flows.get_or_init(|| formulas.by_flows(self.problem.y0()));
        Metropolis::new(&self.problem(), flows, beta)
    }

    fn has_kinks(&self) -> bool {
        self.formulas.as_ref().is_some_and(|formulas| formulas.has_kinks())
    }

    fn fastest(&self) -> f64 {
        self.formulas.as_ref().map_or(0.0, |_| fastest(self.system(), self.problem.y0()))
    }

    /// None for a lattice: a point would have a dimension for every noise of every spin in every
    /// step.
    fn expect(&self) -> Option<Expect<'_>> {
        self.formulas.as_ref()?;
        Some(Expect::at_run_time(&self.problem).ok()?.with_friction(&self.friction))
    }

    fn system(&self) -> &dyn System {
        self.problem.system()
    }
}

/// Largest number of components whose equations are printed.
const MAX_LINES: usize = 100;

/// Facts about a system that are found within milliseconds.
#[derive(Clone, Default)]
pub struct Known {
    /// Equation as it was understood, component by component.
    pub equations: Vec<String>,
    /// Casimirs and the law of the energy.
    pub laws: Vec<String>,
    /// A mistake in the system, in words, if there is one.
    pub mistake: Option<String>,
    /// How a part of the equation was understood that can be understood in two ways.
    pub remark: Option<Warning>,
}

impl Known {
    /// The mistake and the remark as warnings.
    pub fn warnings(self) -> impl Iterator<Item = Warning> {
        self.mistake.map(Warning::new).into_iter().chain(self.remark)
    }

    /// The equation as lines, of a large system the first; empty for a system of the project.
    pub fn equation(&self) -> String {
        let shown = &self.equations[..self.equations.len().min(MAX_LINES)];
        let more = match self.equations.len() - shown.len() {
            0 if shown.is_empty() => return String::new(),
            0 => String::new(),
            more => format!("  and of {more} more components\n"),
        };
        format!("The equation as it was understood\n  {}\n{more}", shown.join("\n  "))
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
    /// The sizes of a lattice; none of other systems.
    pub sizes: Vec<usize>,
    /// The components, and further names that formulas of observables may use.
    pub names: Names,
    /// H₀; none of an equation without B and H.
    pub energy: Option<Further>,
    /// Observables that the system itself provides.
    pub quantities: Vec<Observable>,
}

impl Built {
    fn new(model: impl Model + 'static, names: Names, energy: Option<Further>) -> Self {
        let (sizes, quantities) = (Vec::new(), Vec::new());
        Self { model: Box::new(model), sizes, names, energy, quantities }
    }
}

/// The problem of a scene with a system and its damping.
fn problem(
    Reading { settings, .. }: &Reading,
    system: Arc<dyn System>,
    damping: Arc<dyn Damping>,
    y0: Vec<f64>,
) -> Read<run_time::Problem> {
    run_time::Problem::new(system, damping, y0, settings.until)
        .map_err(|error| Wrong::new(&settings.initial, error))
}

/// Builds the model of a scene.
pub fn build(reading: &Reading) -> Read<Built> {
    let SystemTable { name, structure, energy, noises, drift, .. } = &reading.file.system;
    let is_plain = structure.is_none() && energy.is_none() && noises.is_none();
    match (name, drift) {
        (Some(name), _) => project::build(reading, name),
        (None, Some(drift)) if is_plain => formulas::build_plain(reading, drift),
        _ => formulas::build(reading),
    }
}

/// A text in which `y1`, `y2`, … are the names of the components.
pub fn with_names(text: &str, components: &[String]) -> String {
    let mut parts = text.split('y');
    let mut before = parts.next().unwrap_or_default();
    let mut named = before.to_owned();
    for part in parts {
        let (digits, rest) = part.split_at(part.bytes().take_while(u8::is_ascii_digit).count());
        let is_word = before.ends_with(|c: char| c.is_alphanumeric() || c == '_');
        let number = digits.parse::<usize>().ok().filter(|_| !is_word);
        match number.and_then(|number| components.get(number.checked_sub(1)?)) {
            Some(name) => named += name,
            None => named += &format!("y{digits}"),
        }
        named += rest;
        before = rest;
    }
    named
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
