//! Experiments: their conditions and their findings.

use mc::{Problem, Simulation};

use crate::*;

/// Conditions of an experiment: seed, size and number.
pub struct Conditions<'a> {
    /// Master seed.
    pub seed: u64,
    /// Whether there are fewer steps and samples than in the paper, for continuous integration:
    /// intervals are wide and verdicts often undecided.
    pub quick: bool,
    /// Number of the experiment ([`streams`]), so that no two share noise.
    pub experiment: u64,
    /// Identifier of the panel or statement, where the experiment makes a single one.
    pub id: &'a str,
}

/// The truncation order of the reproduction. The theorems ask k ≥ 2; with k = 2 a handful of
/// clipped increments dominates the mean-square error, with k = 4 none is clipped.
pub const TRUNCATION_ORDER: u32 = 4;

impl Conditions<'_> {
    /// The streams of part number `part` of the experiment.
    pub fn key(&self, part: u64) -> StreamKey {
        streams::key(self.seed, self.experiment, part)
    }

    /// Path number `path` of a scheme on the streams of part number `part`, in `steps` steps.
    ///
    /// # Panics
    /// When there is no such part, or truncation is not defined for such steps.
    pub fn path(&self, part: u64, setup: &Setup<'_>, steps: u64, path: u64) -> Path {
        followed(setup, steps, truncation(), self.key(part), path)
    }

    /// Chooses `paper` at the paper's sizes, `quick` for continuous integration.
    pub fn choose<T>(&self, paper: T, quick: T) -> T {
        if self.quick { quick } else { paper }
    }
}

/// The schemes of the paper in the order of its legends.
pub fn of_paper<'a>(compiled: &Compiled<'a>) -> Vec<Curve<'a>> {
    compiled.curves(&[BuiltIn::Sexp, BuiltIn::EulerMaruyama, BuiltIn::Midpoint])
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
    (0..).zip(table.times()).map(|(n, t)| (*t, state(n))).collect()
}

/// Distance |y − x|.
pub fn distance(y: &[f64], x: &[f64]) -> f64 {
    y.iter().zip(x).map(|(y, x)| (y - x) * (y - x)).sum::<f64>().sqrt()
}

/// The truncation of the reproduction.
pub fn truncation() -> Truncation {
    valid(Truncation::new(TRUNCATION_ORDER))
}

/// Findings of an experiment: figures and claims.
#[derive(Default)]
pub struct Findings {
    /// Figures.
    pub panels: Vec<Panel>,
    /// Claims, measured on them or on their own.
    pub claims: Vec<Claim>,
}

impl Findings {
    /// Claims without a figure.
    pub fn of(claims: impl IntoIterator<Item = Claim>) -> Self {
        Self { claims: claims.into_iter().collect(), panels: Vec::new() }
    }
}

/// One set of runs, which makes panels, claims or both: the ids of the panels or of the statement,
/// and the function that runs it.
// Tables of them are statics: each program that reads a constant compiles what is in it once more.
pub type Experiment = (&'static [&'static str], fn(&Conditions<'_>) -> Findings);

/// Figure in words: its title, the system and its parameters, and the statement of the paper about
/// it.
pub type Words = [&'static str; 3];

/// The paper's systems and their parameters in words.
pub const BODY_3: &str = "rigid body, three noises, I = (2, 1, 2/3), Î = (1, 2, 3)";
pub const BODY_1: &str = "rigid body, only W₁, I = (2, 1, 2/3), Î₁ = 1";
pub const BODY_ENERGY: &str = "rigid body, one noise H₀, I = (2, 1, 2/3)";
pub const VOLTERRA: &str = "Lotka–Volterra, a = −1, b = −1, c = 1";
pub const POISSON: &str = "three-dimensional Poisson system, c = 1";

/// Truncation of increments in most panels, in words.
pub const TRUNCATED: &str = "increments truncated with k = 4";

/// Creates a panel without curves, whose set-up is "system, γ = …, y₀ = …, T = …, steps".
pub fn panel(words: Words, id: &str, kind: Kind, problem: &Problem<'_>, steps: &str) -> Panel {
    let start: Vec<_> = problem.y0.iter().map(|y| ((1e4 * y).round() / 1e4).to_string()).collect();
    let (start, damping) = (start.join(", "), problem.damping.describe());
    let (t_end, [title, system, paper]) = (problem.t_end, words);
    Panel {
        id: id.into(),
        kind,
        title: title.into(),
        setup: format!("{system}, {damping}, y₀ = ({start}), T = {t_end}, {steps}"),
        paper: paper.into(),
        ..Panel::default()
    }
}
