//! **Scenes: damped stochastic Poisson systems from a text file, for programs.**
//!
//! [`Scene::new`] reads a scene and checks it; its [`Model`] is
//! the problem with every scheme for it. The program `casimir` is made of these.
//!
//! The way through: text → `file` (keys) → `run`, `observe` (checked) → `model`. What is computed
//! of scenes is in the crate `verbs`; the program adds a command line and folders.
//!
//! ```
//! use casimir::mc::Simulation;
//! use scenes::{Changes, Scene, Source};
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
//! "#;
//! let source = Source::new("oscillator.toml", text);
//! let scene = Scene::new(source, &Changes::default())?;
//! let setup = scene.setup("sexp")?;
//! let simulation = Simulation::new(setup, scene.settings.truncation);
//! let paths = simulation.paths(scene.settings.steps, scene.settings.key, 0..2)?;
//! assert_eq!(paths.len(), 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod figures;
pub mod gallery;
mod meaning;
pub mod model;
mod sweep;

pub use figures::FigureSettings;
pub use keys::*;
pub use sweep::{Changed, Combination, Nearby, Sweep, Varied};

use std::{fmt::Display, path::Path, sync::Arc};

use casimir::{
    formula::nearest,
    mc::{Along, Column, InTimeAt, Problem, Role, Setup},
    schemes::BuiltIn,
    study::Wanted,
};

use model::Model;

/// A checked scene.
pub struct Scene {
    /// Text of the scene.
    pub source: Source,
    /// Changes made by the command line.
    pub changes: Arc<Changes>,
    /// The title of reports.
    pub title: String,
    /// The names of the components.
    pub components: Vec<String>,
    /// The sizes of a lattice; none of other systems.
    pub sizes: Vec<usize>,
    /// Columns of tables, if chosen.
    chosen: Option<Vec<String>>,
    /// The system with its damping and initial value.
    pub model: Box<dyn Model>,
    /// Settings of the simulation.
    pub settings: Settings,
    /// Observables; the components follow if there are few.
    pub observables: Vec<Observable>,
    /// Quantities that paths collect for the observables, such as integrals.
    collected: Vec<Along>,
    /// Functions that they integrate or follow, where these change with time.
    in_time: Vec<Arc<dyn InTimeAt>>,
    /// Wanted statistics of the dependence between observables.
    pub wanted: Wanted,
    /// Figures that are drawn.
    pub drawn: FigureSettings,
    /// H₀, unless it depends on time.
    pub energy: Option<Observable>,
    /// Test functions of expectations.
    pub expected: Vec<Observable>,
    /// Half-width of the 95 % intervals of expectations.
    pub accuracy: Option<f64>,
    /// Parameters by which expectations are differentiated.
    pub gradient: Vec<String>,
    /// Parameters that are numbers, with their values.
    pub parameters: Vec<(String, f64)>,
    /// Parameters that are fitted to data.
    pub fitted: Vec<String>,
}

/// Largest number of components that are examined one by one.
pub const MAX_COMPONENTS: usize = 12;

impl Scene {
    /// The scene of a text, with the changes that a command line makes.
    ///
    /// # Errors
    /// [`SceneError`] with line and column of what is wrong.
    pub fn new(source: Source, changes: &Changes) -> Result<Self, SceneError> {
        let file = sweep::settled(&source, changes);
        let read = |file| Self::of(&source, file, &Arc::new(changes.clone()), false);
        source.located(file.and_then(read))
    }

    /// Makes a scene from the keys of a text.
    fn of(
        source: &Source,
        file: SceneFile,
        changes: &Arc<Changes>,
        one_by_one: bool,
    ) -> Read<Self> {
        let constants = Constants::new(&file.system)?;
        let settings = Settings::new(source, &file, &constants, changes, one_by_one)?;
        let reading = Reading { file, constants, settings };
        let model::Built { model, sizes, names, energy, quantities: mut given } =
            model::build(&reading)?;
        let Reading { file, constants, mut settings } = reading;
        if !sizes.is_empty() && model.large().is_none() && model.problem().initial.is_none() {
            // Formulas of places give all paths the same.
            settings.random = None;
        }
        if let (true, None, Some(at)) = (one_by_one, model.large(), &file.run.snapshots) {
            let words = "snapshots are of up to 99 paths of a `spin-lattice` of at least";
            refuse!(at, "{words} {} spins", model::MANY_SITES);
        }
        let (components, y0) = (names.variables().to_vec(), model.problem().y0);
        let description = model.system().description();
        let in_steps = (!description.layout.is_tiled()).then(|| names.clone());
        let mut vocabulary = Vocabulary::new(names, energy.clone(), &y0);
        let energy = energy.filter(|_| !description.depends_on_time);
        let energy = energy.and_then(|energy| vocabulary.of(energy).ok());
        given.iter().for_each(|of| vocabulary.know(of));
        if components.len() <= MAX_COMPONENTS {
            let own = components.iter().enumerate();
            given.extend(own.map(|(i, name)| Observable::new(name, Quantity::Component(i))));
        }
        let mut observables = Vec::<Observable>::new();
        let names = file.observe.keys().chain(file.events.keys()).chain(file.probabilities.keys());
        for name in names {
            let known = components.contains(name)
                || observables.iter().chain(&given).any(|known| known.name == **name);
            if known || is_column(name) {
                return Err(taken(name));
            }
            let new = if let Some(event) = file.events.get(name) {
                let [happened, time] = vocabulary.event(event, in_steps.as_ref())?;
                let time = Observable::new(format!("{} time", **name), time);
                vec![Observable::new(&**name, happened), time]
            } else {
                let condition = file.probabilities.get(name);
                condition.map_or(Ok(()), |text| vocabulary.demand_condition(text))?;
                let text = condition.unwrap_or_else(|| &file.observe[name]);
                vec![Observable::new(&**name, vocabulary.observable(text)?)]
            };
            new.iter().for_each(|of| vocabulary.know(of));
            observables.extend(new);
        }
        observables.extend(given);
        let stem = Path::new(&source.name).file_stem().map(|stem| stem.to_string_lossy().into());
        let name = file.system.name.as_deref().cloned();
        let title = file.title.or(name).or(stem).unwrap_or_default();
        let accuracy = file.expect.as_ref().and_then(|table| table.accuracy.as_ref());
        let mut scene = Self {
            source: source.clone(),
            changes: Arc::clone(changes),
            title,
            components,
            sizes,
            chosen: None,
            model,
            settings,
            observables,
            collected: Vec::new(),
            in_time: Vec::new(),
            wanted: Wanted::default(),
            drawn: FigureSettings::default(),
            energy: energy.map(|energy| Observable::new("H0", energy)),
            expected: Vec::new(),
            accuracy: changes.accuracy.or(accuracy.map(|accuracy| **accuracy)),
            gradient: match (&changes.gradient[..], &file.expect) {
                ([], Some(table)) => strings(&table.gradient),
                (given, _) => given.to_vec(),
            },
            parameters: constants.numbers.clone(),
            fitted: file.fit.map_or(Vec::new(), |fit| strings(&fit.parameters)),
        };
        if !changes.of.is_empty() {
            let named = changes.of.iter().map(|text| At::new(0..0, Text(text.clone())));
            let of = scene.expect(&named.collect::<Vec<_>>(), &mut vocabulary);
            of.map_err(|Wrong { message, .. }| Wrong::new(None, format!("--of: {message}")))?;
        } else if let Some(of) = file.expect.as_ref().and_then(|table| table.of.as_ref()) {
            if of.is_empty() {
                refuse!(of, "name at least one function, such as \"y1\"");
            }
            scene.expect(of, &mut vocabulary)?;
        }
        if let Some(accuracy) = accuracy {
            let half_width = **accuracy;
            if !(half_width > 0.0 && half_width.is_finite()) {
                refuse!(accuracy, "the accuracy must be positive and finite, got {half_width}");
            }
        }
        if scene.observables.is_empty() {
            scene.observables.clone_from(&scene.expected);
        }
        if scene.observables.is_empty() {
            refuse!(None, "so many components need observables: add [observe]");
        }
        scene.chosen = figures::chosen(&file.run.columns, |name| match is_column(name) {
            true => Ok(name.to_string()),
            false => scene.column(name, &GROUPS),
        })?;
        scene.wanted = figures::wanted(&file.statistics, &scene, &constants)?;
        let conditions = file.probabilities.keys().chain(file.events.keys());
        scene.wanted.probabilities = conditions.filter_map(|name| scene.place(name)).collect();
        let spectrum = |name: &Name| format!("spectrum({})", **name);
        let spectra: Vec<String> = file.statistics.autocorrelation.iter().map(spectrum).collect();
        let others = file.system.parameters.keys().map(|key| key.as_str());
        let others: Vec<&str> = others.chain(spectra.iter().map(|name| &**name)).collect();
        scene.drawn = FigureSettings::new(&file.figures, &scene, &others)?;
        (scene.collected, scene.in_time) = (vocabulary.collected, vocabulary.in_time);
        let scheme = &scene.settings.scheme;
        if scheme != AUTO {
            // Whether it is for the system is asked by commands that take it.
            scene.built_in(scheme)?;
        }
        Ok(scene)
    }

    /// Reads test functions.
    fn expect(&mut self, of: &[At<Text>], vocabulary: &mut Vocabulary) -> Read<()> {
        for text in of {
            let name = text.0.as_str();
            if self.expected.iter().any(|before| before.name == name) {
                refuse!(text, "`{name}` is listed twice");
            }
            let component = self.components.iter().position(|component| component == name);
            let quantity = match (self.place(name), component) {
                (Some(k), _) => self.observables[k].quantity.clone(),
                (_, Some(i)) => Quantity::Component(i),
                _ => vocabulary.quantity(text)?,
            };
            self.expected.push(Observable::new(name, quantity));
        }
        Ok(())
    }

    /// The problem and a scheme for it by its name.
    ///
    /// # Errors
    /// [`SceneError`] with the reason why the scheme does not fit the system.
    pub fn setup(&self, name: &str) -> Result<Setup<'_>, SceneError> {
        let scheme = self.source.located(self.built_in(name))?;
        let place = self.settings.scheme_place.clone();
        let scheme = self.model.scheme(scheme).map_err(|error| self.source.error(place, error))?;
        Ok(Setup { problem: self.problem(), scheme })
    }

    fn built_in(&self, name: &str) -> Read<BuiltIn> {
        BuiltIn::named(name).ok_or_else(|| {
            let known = [&[AUTO][..], &BuiltIn::ALL.map(BuiltIn::id)].concat();
            let message = format!("no scheme `{name}`{}", among(name, &known));
            Wrong::new(self.settings.scheme_place.clone(), message)
        })
    }

    /// Scenes near this one, each with a [parameter](Self::gradient) changed by its number.
    ///
    /// # Errors
    /// [`SceneError`] if there is no such parameter, or a changed scene is none.
    pub fn nearby(&self, changes: &[f64]) -> Result<Nearby, SceneError> {
        self.source.located(Nearby::of(self, changes))
    }

    /// The scene at other values of parameters, by which its expectations of other functions are
    /// differentiated.
    ///
    /// # Errors
    /// [`SceneError`] if a function or a value is wrong.
    pub fn at(&self, of: &[String], values: &[(String, f64)]) -> Result<Self, SceneError> {
        let mut changes = Changes { of: of.to_vec(), ..(*self.changes).clone() };
        changes.gradient = values.iter().map(|(name, _)| name.clone()).collect();
        changes.scheme.sets.retain(|set| !changes.gradient.contains(&set.name));
        let set = |(name, value): &(String, f64)| Set::of(name, *value);
        changes.scheme.sets.extend(values.iter().map(set));
        Self::new(self.source.clone(), &changes)
    }

    /// Adds the quantities that paths collect to a setup.
    pub fn collecting<'a>(&'a self, setup: Setup<'a>) -> Setup<'a> {
        let mut setup = setup.collecting(self.model.system(), self.collected.clone());
        for followed in &self.in_time {
            setup.problem.in_time.push(followed.clone());
        }
        setup
    }

    /// The functions whose weak orders are measured: those of `[expect]`, or the first observable.
    pub fn tested(&self) -> impl Iterator<Item = &Observable> {
        let first = usize::from(self.expected.is_empty());
        self.observables.iter().take(first).chain(&self.expected)
    }

    /// Whether paths collect something, so that states alone do not say what is observed.
    pub fn collects(&self) -> bool {
        !self.collected.is_empty()
    }

    /// The problem with its initial values.
    pub fn problem(&self) -> Problem<'_> {
        let problem = self.model.problem();
        let initial = problem.initial.clone().or_else(|| self.settings.random.clone());
        Problem { initial, device: self.source.device.as_deref(), ..problem }
    }

    /// An error about the steps.
    pub fn steps_error(&self, message: impl Display) -> SceneError {
        self.source.error(self.settings.steps_place.clone(), message)
    }

    /// Checks that a name is a component, an observable, or one of others.
    fn column(&self, name: &Name, others: &[&str]) -> Read<String> {
        let observables = self.observables.iter().map(|observable| &observable.name);
        let known = self.components.iter().chain(observables).map(|name| &**name);
        let known = known.chain(others.iter().copied());
        if !known.clone().any(|known| known == name.as_str()) {
            refuse!(name, "no column `{}`{}", **name, nearest(name, known));
        }
        Ok(name.to_string())
    }

    /// The number of an observable.
    fn observable(&self, name: &Name) -> Read<usize> {
        self.column(name, &[])?;
        self.place(name).ok_or_else(|| {
            let message = format!("add `{0} = \"{0}\"` to [observe] first", **name);
            Wrong::new(name, message)
        })
    }

    fn place(&self, name: &str) -> Option<usize> {
        self.observables.iter().position(|known| known.name == name)
    }

    /// Whether tables contain the column.
    pub fn keeps(&self, Column { name, role, .. }: &Column) -> bool {
        let group = match role {
            Role::Time => return true,
            Role::Component => GROUPS[0],
            Role::Observable => name,
            Role::Conserved | Role::Defect { .. } => GROUPS[1],
        };
        match &self.chosen {
            Some(chosen) => chosen.iter().any(|one| one == name || one == group),
            None => group != GROUPS[0] || self.components.len() <= MAX_COMPONENTS,
        }
    }
}

/// Names that stand for groups of columns.
const GROUPS: [&str; 2] = ["components", "laws"];
