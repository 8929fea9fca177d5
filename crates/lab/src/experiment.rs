//! What an experiment is, and what it is told.

use noise::{StreamKey, Truncation};
use verify::results::{Claim, Panel};
use verify::{Mode, Progress, Settings};

/// What an experiment is told.
pub struct Context<'a> {
    /// Seed and mode.
    pub settings: Settings,
    /// Number of the experiment, so that no two share noise.
    pub experiment: u64,
    /// Which panels are wanted of those that the experiment can make.
    pub wanted: &'a [&'a str],
    /// Who is told how far it is.
    pub progress: &'a dyn Progress,
}

/// The truncation order of the reproduction. The theorems ask k ≥ 2; with k = 2 a handful of
/// clipped increments dominates the mean-square error, with k = 4 none is clipped.
pub(crate) const TRUNCATION_ORDER: u32 = 4;

/// Streams for the parts of one experiment.
const PARTS_PER_EXPERIMENT: u64 = 16;

impl Context<'_> {
    /// The family of streams of part number `part` of the experiment.
    pub(crate) fn key(&self, part: u64) -> StreamKey {
        assert!(
            part < PARTS_PER_EXPERIMENT,
            "part {part} would share its noise with the next experiment"
        );
        StreamKey {
            seed: self.settings.seed,
            experiment: self.experiment * PARTS_PER_EXPERIMENT + part,
        }
    }

    pub(crate) fn wants(&self, panel: &str) -> bool {
        self.wanted.contains(&panel)
    }

    /// `paper` at the paper's sizes, `quick` for continuous integration.
    pub(crate) fn choose<T>(&self, paper: T, quick: T) -> T {
        match self.settings.mode {
            Mode::Paper => paper,
            Mode::Quick => quick,
        }
    }
}

/// The truncation of the reproduction.
pub(crate) fn truncation() -> Truncation {
    Truncation::new(TRUNCATION_ORDER)
        .unwrap_or_else(|error| unreachable!("the order is a positive constant: {error}"))
}

/// The largest truncated increment of the reproduction at a step size below one.
pub(crate) fn bound(tau: f64) -> f64 {
    truncation().bound(tau).unwrap_or_else(|error| unreachable!("the steps are below one: {error}"))
}

/// What an experiment yields.
pub struct Yield {
    /// Panels of the paper.
    pub panels: Vec<Panel>,
    /// Claims measured on them.
    pub claims: Vec<Claim>,
}

/// One set of runs, which makes one or more panels.
pub struct Experiment {
    /// The panels it can make.
    pub panels: &'static [&'static str],
    /// Runs it.
    pub run: fn(&Context<'_>) -> Yield,
}

/// A statement of the paper with its measurement.
pub type Statement = verify::Statement<fn(&Context<'_>) -> Vec<Claim>>;

/// A wrong method with its measurement.
pub type Twin = verify::Twin<fn(&Context<'_>) -> Claim>;
