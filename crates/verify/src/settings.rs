//! How much to compute.

/// How much to compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// The paper's step and sample sizes.
    Paper,
    /// Fewer steps and samples, for continuous integration; intervals are wide and verdicts often
    /// undecided.
    Quick,
}

impl Mode {
    /// `paper` or `quick`, as in results.
    pub fn id(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Quick => "quick",
        }
    }
}

/// What a run is made of.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Master seed.
    pub seed: u64,
    /// How much to compute.
    pub mode: Mode,
    /// How often the mode's numbers of paths, in whole groups, so that a study can be extended;
    /// `None` for the mode's numbers themselves.
    pub samples_times: Option<f64>,
}

impl Settings {
    /// With the mode's numbers of paths.
    pub fn new(seed: u64, mode: Mode) -> Self {
        Self { seed, mode, samples_times: None }
    }
}
