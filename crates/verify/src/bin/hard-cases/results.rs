//! The contract of `stability.json`.

use analysis::results::Provenance;
use serde::Serialize;

use crate::{
    case::Case,
    row::{Row, Verdict},
};

/// Raised whenever a reader of an older version would misread a newer one.
pub const SCHEMA: u32 = 1;

/// Everything that was tried.
#[derive(Serialize)]
pub struct Stability {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Where it comes from.
    pub provenance: Provenance,
    /// The hard cases.
    pub cases: Vec<CaseResult>,
    /// The conformal law over long times.
    pub growth: Vec<Growth>,
    /// The energy over long times.
    pub energy: Vec<Energy>,
    /// What was fuzzed.
    pub fuzz: Vec<Fuzzed>,
}

impl Stability {
    /// How many guarantees were refuted, by a case, by a long run or by fuzzing.
    pub fn refuted(&self) -> usize {
        let rows = self.cases.iter().flat_map(|case| &case.rows).map(|row| row.verdict);
        let verdicts = rows.chain(self.growth.iter().map(|run| run.verdict));
        let verdicts = verdicts.chain(self.energy.iter().map(|run| run.verdict));
        verdicts.filter(|verdict| *verdict == Verdict::Refuted).count()
            + self.fuzz.iter().filter(|fuzzed| fuzzed.failures > 0).count()
    }
}

/// One family of hard inputs.
#[derive(Serialize)]
pub struct CaseResult {
    /// What the case is about.
    #[serde(flatten)]
    pub case: &'static Case,
    /// Every setting with every scheme.
    pub rows: Vec<Row>,
}

/// How the distance from the conformal law grows over a long time.
#[derive(Serialize)]
pub struct Growth {
    /// Identifier.
    pub id: &'static str,
    /// System, damping and step in words.
    pub setup: String,
    /// The scheme.
    pub scheme: &'static str,
    /// The invariant.
    pub invariant: &'static str,
    /// Independent paths.
    pub paths: usize,
    /// The relative defect over the paths.
    pub points: Vec<GrowthPoint>,
    /// The exponent q of the root mean square ∝ n^q.
    pub exponent: f64,
    /// Lower end of its 95 % interval.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
    /// n·ε: what the defect would be if every step added one ε in the same direction.
    pub linear: f64,
    /// What became of the guarantee.
    pub verdict: Verdict,
    /// Whether the figure shows it.
    #[serde(skip)]
    pub drawn: bool,
}

/// The defect d = F(y_n)e^{pΓ}/F(y₀) − 1 after n steps.
#[derive(Serialize)]
pub struct GrowthPoint {
    /// n.
    pub steps: u64,
    /// Root mean square of d.
    pub rms: f64,
    /// Mean of d.
    pub mean: f64,
    /// Largest |d|.
    pub max: f64,
}

/// The distance d of E[H₀] from its exact value over a long time.
#[derive(Clone, Serialize)]
pub struct Energy {
    /// System and step in words.
    pub system: &'static str,
    /// The scheme.
    pub scheme: &'static str,
    /// Steps.
    pub steps: u64,
    /// The mean of d over the second half of the time.
    pub end: f64,
    /// By how much it changed since 1/16 of the time, in units of what the noise added meanwhile.
    pub drift: f64,
    /// Its standard error.
    pub error: f64,
    /// The exponent a of |d| ∝ tᵃ, and the ends of its 95 % interval.
    pub exponent: (f64, f64, f64),
    /// Paths that failed.
    pub failed: usize,
    /// `bounded`, `drifts` or `fails`.
    pub outcome: &'static str,
    /// What became of the guarantee.
    pub verdict: Verdict,
}

/// One target of the fuzzer.
#[derive(Default, Serialize)]
pub struct Fuzzed {
    /// What was fed.
    pub target: &'static str,
    /// What is checked.
    pub checks: &'static str,
    /// Inputs.
    pub inputs: u64,
    /// Inputs that were accepted.
    pub accepted: u64,
    /// Inputs that were refused with a typed error, or ended in one.
    pub refused: u64,
    /// The largest number of iterations of one solve, where something is solved.
    pub most_iterations: u64,
    /// Inputs that broke a check.
    pub failures: u64,
    /// The first few of them, in words.
    pub examples: Vec<String>,
}
