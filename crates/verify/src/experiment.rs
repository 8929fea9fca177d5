//! What an experiment is, what it is given and what it returns.

use mc::{Problem, Setup, Simulation, parts::GROUP_PATHS};
use noise::{StreamKey, Truncation};
use plot::Progress;
use schemes::BuiltIn;
use systems::paper::valid;

use crate::{
    Compiled, Curve,
    results::{Claim, Kind, Panel},
    settings::{Mode, Settings},
    streams,
};

/// What an experiment is given.
pub struct Conditions<'a> {
    /// Seed, mode and number of paths.
    pub settings: Settings,
    /// Number of the experiment ([`streams`]), so that no two share noise.
    pub experiment: u64,
    /// The ids that are wanted of those that the experiment can make.
    pub wanted: &'a [&'a str],
    /// Schemes that are not in the paper and are to be further series of its panels.
    pub further: &'a [BuiltIn],
    /// Is told how far it is.
    pub progress: &'a dyn Progress,
}

/// The schemes that are not in the paper and can be further series of its panels.
pub const FURTHER: [BuiltIn; 4] =
    [BuiltIn::SexpLevy, BuiltIn::SexpLi, BuiltIn::SexpLiLevy, BuiltIn::Split];

/// The truncation order of the reproduction. The theorems ask k ≥ 2; with k = 2 a handful of
/// clipped increments dominates the mean-square error, with k = 4 none is clipped.
pub const TRUNCATION_ORDER: u32 = 4;

impl Conditions<'_> {
    /// The id of what is made, where that is a single panel or statement.
    ///
    /// # Panics
    /// When nothing is wanted, as of twins.
    pub fn id(&self) -> &str {
        self.wanted[0]
    }

    /// The streams of part number `part` of the experiment.
    pub fn key(&self, part: u64) -> StreamKey {
        streams::key(self.settings.seed, self.experiment, part)
    }

    /// Path number `path` of a scheme on the streams of part number `part`, in `steps` steps.
    ///
    /// # Panics
    /// When there is no such part, or truncation is not defined for such steps.
    pub fn path(&self, part: u64, setup: &Setup<'_>, steps: u64, path: u64) -> Path {
        followed(setup, steps, truncation(), self.key(part), path)
    }

    /// The schemes of the paper in the order of its legends, then the further ones without areas
    /// that are for this system.
    pub fn curves<'a>(&self, compiled: &Compiled<'a>) -> Vec<Curve<'a>> {
        let further = self.further.iter().filter(|scheme| !scheme.is_for_areas());
        let paper = [BuiltIn::Sexp, BuiltIn::EulerMaruyama, BuiltIn::Midpoint];
        compiled.curves(&paper.iter().chain(further).copied().collect::<Vec<_>>())
    }

    /// A number of paths, as often as the settings want it, in whole groups; the number itself
    /// where they want nothing.
    pub fn paths(&self, paths: u64) -> u64 {
        self.settings.samples_times.map_or(paths, |times| {
            let groups = (times * paths as f64 / GROUP_PATHS as f64).ceil();
            groups as u64 * GROUP_PATHS
        })
    }

    /// How often there are these paths, in words after a comma; nothing where nothing was wanted.
    pub fn times_in_words(&self) -> String {
        let whose = self.choose("paper's", "quick mode's");
        let times = self.settings.samples_times;
        times.map_or(String::new(), |times| format!(", {times} times the {whose} paths"))
    }

    /// `paper` at the paper's sizes, `quick` for continuous integration.
    pub fn choose<T>(&self, paper: T, quick: T) -> T {
        match self.settings.mode {
            Mode::Paper => paper,
            Mode::Quick => quick,
        }
    }
}

/// The times and states of a path, up to a step that fails.
pub type Path = Vec<(f64, Vec<f64>)>;

/// Path number `path` of a scheme.
///
/// # Panics
/// When truncation is not defined for such steps.
pub fn followed(
    setup: &Setup<'_>,
    steps: u64,
    truncation: Truncation,
    key: StreamKey,
    path: u64,
) -> Path {
    let table = valid(Simulation::new(setup.clone(), truncation).path(steps, key, path));
    let components = &table.columns[1..=setup.problem.y0.len()];
    let state = |n: usize| components.iter().map(|component| component.values[n]).collect();
    table.times().iter().enumerate().map(|(n, &t)| (t, state(n))).collect()
}

/// |y − x|².
pub fn squared_distance(y: &[f64], x: &[f64]) -> f64 {
    y.iter().zip(x).map(|(y, x)| (y - x) * (y - x)).sum()
}

/// The truncation of the reproduction.
pub fn truncation() -> Truncation {
    valid(Truncation::new(TRUNCATION_ORDER))
}

/// What an experiment found.
#[derive(Default)]
pub struct Findings {
    /// Figures.
    pub panels: Vec<Panel>,
    /// Claims, measured on them or on their own.
    pub claims: Vec<Claim>,
}

impl From<Vec<Claim>> for Findings {
    fn from(claims: Vec<Claim>) -> Self {
        Self { claims, panels: Vec::new() }
    }
}

/// One set of runs, which makes panels, claims or both.
#[derive(Clone, Copy)]
pub struct Experiment {
    /// The ids of what it makes: of panels, or of a statement.
    pub ids: &'static [&'static str],
    /// Runs it.
    pub run: fn(&Conditions) -> Findings,
}

impl Experiment {
    pub(crate) const fn new(
        ids: &'static [&'static str],
        run: fn(&Conditions) -> Findings,
    ) -> Self {
        Self { ids, run }
    }
}

/// A figure in words.
#[derive(Clone, Copy)]
pub struct Words {
    pub title: &'static str,
    /// The system and its parameters.
    pub system: &'static str,
    /// What the paper says that the figure shows.
    pub paper: &'static str,
}

/// The paper's systems and their parameters in words.
pub mod in_words {
    pub const PENDULUM: &str = "pendulum, c = 1";
    pub const BODY_3: &str = "rigid body, three noises, I = (2, 1, 2/3), Î = (1, 2, 3)";
    pub const BODY_1: &str = "rigid body, only W₁, I = (2, 1, 2/3), Î₁ = 1";
    pub const BODY_ENERGY: &str = "rigid body, one noise H₀, I = (2, 1, 2/3)";
    pub const VOLTERRA: &str = "Lotka–Volterra, a = −1, b = −1, c = 1";
    pub const POISSON: &str = "three-dimensional Poisson system, c = 1";
}

/// How increments are truncated in most panels, in words.
pub const TRUNCATED: &str = "increments truncated with k = 4";

impl Words {
    /// A panel without curves, whose set-up is "system, γ = …, y₀ = …, T = …, steps".
    pub fn panel(&self, id: &str, kind: Kind, problem: &Problem<'_>, steps: &str) -> Panel {
        let [id, title, paper] = [id, self.title, self.paper].map(str::to_owned);
        let start = problem.y0.iter().map(|y| ((1e4 * y).round() / 1e4).to_string());
        let (start, damping) = (start.collect::<Vec<_>>().join(", "), problem.damping.describe());
        let (system, t_end) = (self.system, problem.t_end);
        let setup = format!("{system}, {damping}, y₀ = ({start}), T = {t_end}, {steps}");
        Panel { id, kind, title, setup, paper, ..Panel::default() }
    }
}
