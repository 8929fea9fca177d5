//! The contract of `stability.json`; documented for other languages in `docs/stability.md`.

use serde::{Deserialize, Serialize};
pub use verify::results::Provenance;

/// Raised whenever a reader of an older version would misread a newer one.
pub const SCHEMA: u32 = 1;

/// Everything that was tried.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Stability {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Where it comes from.
    pub provenance: Provenance,
    /// The hard cases.
    pub cases: Vec<Case>,
    /// The conformal law over long times.
    pub growth: Vec<Growth>,
    /// What was fuzzed.
    pub fuzz: Vec<Fuzzed>,
}

impl Stability {
    /// How many guarantees were refuted, by a case, by a long run or by fuzzing.
    #[must_use]
    pub fn refuted(&self) -> usize {
        let rows = self
            .cases
            .iter()
            .flat_map(|case| &case.rows)
            .filter(|row| row.verdict == Verdict::Refuted);
        let growth = self.growth.iter().filter(|growth| growth.verdict == Verdict::Refuted);
        let fuzz = self.fuzz.iter().filter(|fuzzed| fuzzed.failures > 0);
        rows.count() + growth.count() + fuzz.count()
    }
}

/// What became of a guarantee.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The stated bound was kept.
    Holds,
    /// Theory says that the scheme fails here, and it does.
    FailsAsItMust,
    /// Nothing is guaranteed; this is what was seen.
    Observed,
    /// A stated bound was broken, or a scheme that must fail did not.
    Refuted,
}

/// One family of hard inputs.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Case {
    /// Identifier, for example `stiff-damping`.
    pub id: String,
    /// What it is called.
    pub title: String,
    /// System, damping, steps and noise in words.
    pub setup: String,
    /// What exact mathematics says.
    pub mathematics: String,
    /// What `measured` is.
    pub quantity: String,
    /// What is guaranteed, and why.
    pub guarantee: String,
    /// What the settings vary.
    pub varied: String,
    /// Every setting with every scheme.
    pub rows: Vec<Row>,
}

/// One scheme in one setting of a case.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Row {
    /// The setting in words.
    pub setting: String,
    /// The setting as a number, where it is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x: Option<f64>,
    /// `sexp`, `sexp-newton`, `sexp-levy`, `midpoint`, `heun`, `em`; or what else is put to the
    /// test.
    pub scheme: String,
    /// The measured figure; none where the scheme stopped with an error before there was one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured: Option<f64>,
    /// What the figure is in exact mathematics, where that is a number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exact: Option<f64>,
    /// The bound that is guaranteed, or that a scheme that must fail has to break.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bound: Option<f64>,
    /// The typed error that ended the run, if one did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// What became of the guarantee.
    pub verdict: Verdict,
}

/// How the distance from the conformal law grows over a long time.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Growth {
    /// Identifier.
    pub id: String,
    /// System, damping and step in words.
    pub setup: String,
    /// The scheme.
    pub scheme: String,
    /// The invariant.
    pub invariant: String,
    /// Independent paths.
    pub paths: usize,
    /// Root mean square and mean of the relative defect over the paths.
    pub points: Vec<GrowthPoint>,
    /// The exponent q of the root mean square ∝ n^q.
    pub exponent: f64,
    /// Lower end of its 95 % interval.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
    /// What the defect would be if every step added an error of one unit roundoff in the same
    /// direction.
    pub linear: f64,
    /// What became of the guarantee.
    pub verdict: Verdict,
}

/// The defect after n steps.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct GrowthPoint {
    /// n.
    pub steps: u64,
    /// (mean of d²)^½, where d = F(y_n)e^{pΓ}/F(y₀) − 1.
    pub rms: f64,
    /// Mean of d.
    pub mean: f64,
    /// Largest |d|.
    pub max: f64,
}

/// What was fuzzed with how many inputs.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Fuzzed {
    /// What was fed.
    pub target: String,
    /// What is checked.
    pub checks: String,
    /// Inputs.
    pub inputs: u64,
    /// Inputs that were accepted.
    pub accepted: u64,
    /// Inputs that were refused with a typed error, or ended in one.
    pub refused: u64,
    /// The largest number of evaluations of one solve, where something is solved.
    pub most_iterations: u64,
    /// Inputs that broke a check.
    pub failures: u64,
    /// The first few of them, in words.
    pub examples: Vec<String>,
}
