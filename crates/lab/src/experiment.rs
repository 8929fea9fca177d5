//! What an experiment is, what it is given and what it returns.

use noise::{StreamKey, Truncation};
use systems::{Damping, Problem, paper::valid};
use verify::{
    Mode, Progress, Settings,
    results::{Claim, Kind, Panel},
};

use crate::streams;

/// What an experiment is given.
pub struct Conditions<'a> {
    /// Seed and mode.
    pub settings: Settings,
    /// Number of the experiment ([`streams`]), so that no two share noise.
    pub experiment: u64,
    /// The ids that are wanted of those that the experiment can make.
    pub wanted: &'a [&'a str],
    /// Is told how far it is.
    pub progress: &'a dyn Progress,
}

/// The truncation order of the reproduction. The theorems ask k ≥ 2; with k = 2 a handful of
/// clipped increments dominates the mean-square error, with k = 4 none is clipped.
pub const TRUNCATION_ORDER: u32 = 4;

impl Conditions<'_> {
    /// The streams of part number `part` of the experiment.
    pub fn key(&self, part: u64) -> StreamKey {
        streams::key(self.settings.seed, self.experiment, part)
    }

    /// `paper` at the paper's sizes, `quick` for continuous integration.
    pub fn choose<T>(&self, paper: T, quick: T) -> T {
        match self.settings.mode {
            Mode::Paper => paper,
            Mode::Quick => quick,
        }
    }
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
pub trait Experiment: Sync {
    /// The ids of what it makes: of panels, or of a statement.
    fn ids(&self) -> Vec<&'static str>;
    /// Runs it.
    fn run(&self, conditions: &Conditions<'_>) -> Findings;
    /// Whether it takes most of the time of a run: the battery repeats it at small sizes only.
    fn takes_long(&self) -> bool {
        false
    }
}

/// An experiment that is a function.
pub struct Measurement {
    /// Its id.
    pub id: &'static str,
    /// Measures.
    pub measure: fn(&Conditions<'_>) -> Findings,
    /// Whether it takes most of the time of a run.
    pub long: bool,
}

impl Experiment for Measurement {
    fn ids(&self) -> Vec<&'static str> {
        vec![self.id]
    }

    fn run(&self, conditions: &Conditions<'_>) -> Findings {
        conditions.progress.begin(self.id, 0);
        let findings = (self.measure)(conditions);
        conditions.progress.end();
        findings
    }

    fn takes_long(&self) -> bool {
        self.long
    }
}

/// A figure in words.
#[derive(Clone, Copy)]
pub struct Words {
    pub id: &'static str,
    pub title: &'static str,
    /// The system and its parameters.
    pub system: &'static str,
    /// What the paper says that the figure shows.
    pub paper: &'static str,
}

/// How increments are truncated in most panels, in words.
pub const TRUNCATED: &str = "increments truncated with k = 4";

impl Words {
    /// A panel without curves; its set-up is "system, γ = …, y₀ = …, T = …, steps".
    pub fn panel<S, G: Damping, const D: usize>(
        &self,
        kind: Kind,
        problem: &Problem<S, G, D>,
        steps: &str,
    ) -> Panel {
        let [id, title, paper] = [self.id, self.title, self.paper].map(str::to_owned);
        let system = self.system;
        let short = |y: &f64| {
            let digits = format!("{y:.4}");
            digits.trim_end_matches('0').trim_end_matches('.').to_owned()
        };
        let start: Vec<String> = problem.y0().iter().map(short).collect();
        let (damping, t_end) = (problem.damping().describe(), problem.t_end());
        let setup =
            format!("{system}, {damping}, y₀ = ({}), T = {t_end}, {steps}", start.join(", "));
        Panel { id, kind, title, setup, paper, ..Panel::default() }
    }
}
